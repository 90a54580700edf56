//! Speed and memory of parsing. `cargo bench --bench parse [-- cart params ...]`
//!
//! 50 MB of simple declarations (required: at least 15 MB/s on one core, at most five times the text in memory), and
//! the cart of the examples (a part of the 50 microseconds from text to modes).

#![allow(clippy::print_stdout)] // a benchmark prints its figures

mod clock;

use clock::Clock;
use std::alloc::{GlobalAlloc, Layout, System};
use std::fmt::Write;
use std::hint::black_box;
use std::sync::atomic::{AtomicUsize, Ordering};
use vibc::base::{FileId, SourceFile, Sources};
use vibc::syntax;

/// The system's allocator, counting the bytes that are held and their maximum.
struct Counting;

static HELD: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

fn grow(bytes: usize) {
    let held = HELD.fetch_add(bytes, Ordering::Relaxed) + bytes;
    PEAK.fetch_max(held, Ordering::Relaxed);
}

// SAFETY: every call is passed unchanged to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        grow(layout.size());
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // The old and the new block exist at the same time while one is copied to the other.
        grow(size);
        let moved = unsafe { System.realloc(pointer, layout, size) };
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        moved
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Median of the processor time.
fn time(runs: usize, mut run: impl FnMut()) -> f64 {
    let once = |run: &mut dyn FnMut()| {
        let clock = Clock::start();
        run();
        clock.seconds()
    };
    let mut times: Vec<f64> = (0..runs).map(|_| once(&mut run)).collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn filled(size: usize, line: Line) -> String {
    let mut text = String::with_capacity(size + 100);
    for i in 1.. {
        if text.len() >= size {
            break;
        }
        line(&mut text, i);
    }
    text
}

fn write(text: &mut String, line: std::fmt::Arguments<'_>) {
    text.write_fmt(line).expect("writing to a string cannot fail");
}

/// Writes the i-th line of a file.
type Line = fn(&mut String, usize);

/// The declarations named in the requirement, alone and mixed, and short ones, which have the most nodes for each byte.
const FILES: [(&str, Line); 5] = [
    ("params", param),
    ("bodies", body),
    ("springs", spring),
    ("mixed", |text, i| [param, body, spring][i % 3](text, i)),
    ("short", |text, _| body(text, 1)),
];

fn param(text: &mut String, i: usize) {
    write(text, format_args!("param a{i} = 10 N/m\n"));
}

fn body(text: &mut String, i: usize) {
    write(text, format_args!("body m{i} {{ mass = 1 kg, moves x }}\n"));
}

fn spring(text: &mut String, i: usize) {
    write(text, format_args!("spring k{i}: m{} -- m{i} {{ k = 100 N/m }}\n", i - 1));
}

fn large(only: &[String]) {
    for (name, line) in FILES {
        if !only.is_empty() && !only.iter().any(|o| o == name) {
            continue;
        }
        let text = filled(50_000_000, line);
        let megabytes = text.len() as f64 / 1e6;
        let before = HELD.load(Ordering::Relaxed);
        let mut sources = Sources::new();
        let text_size = text.len();
        let file = sources.add(SourceFile::model("large.vib", text));
        PEAK.store(before, Ordering::Relaxed);
        let seconds = time(3, || {
            let parsed = syntax::parse(&sources, file);
            assert!(parsed.errors.is_empty());
            black_box(&parsed);
        });
        let peak = PEAK.load(Ordering::Relaxed) - (before - text_size);
        println!(
            "{name:8} {megabytes:5.1} MB {seconds:6.2} s {:6.1} MB/s   peak {:.2} x the text",
            megabytes / seconds,
            peak as f64 / text_size as f64
        );
    }
}

fn cart() {
    let mut sources = Sources::new();
    let text = include_str!("../examples/cart.vib");
    let file: FileId = sources.add(SourceFile::model("cart.vib", text));
    let batch = 1000;
    let seconds = time(31, || {
        for _ in 0..batch {
            black_box(syntax::parse(black_box(&sources), file));
        }
    });
    println!("cart     {:5} bytes {:6.2} us", text.len(), seconds / f64::from(batch) * 1e6);
}

fn main() {
    let only: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    if only.is_empty() || only.iter().any(|name| name == "cart") {
        cart();
    }
    large(&only);
}
