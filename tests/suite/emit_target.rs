//! Emitted C on an emulated microcontroller (Cortex-M4 with hardware floats, doubles in software): the same bits as here.
//! See docs/method/emit.md.

use super::emit::{STRICT, options, silently, write};
use super::systems::{HardCase, number};
use super::transfer::with_every_pair;
use std::fs;
use std::process::{Command, Stdio};
use vibc::analysis::discrete::{Options, Precision};
use vibc::analysis::{self, Signal, discretise};
use vibc::backend::emit::{self, Language, Program};
use vibc::base::Number;
use vibc::system::CoordinateId;

/// Memory of the board `mps2-an386`, with everything loaded within the reach of RAM.
const LINKER: &str = "MEMORY { FLASH (rx) : ORIGIN = 0x00000000, LENGTH = 4M\n RAM (rwx) : ORIGIN = 0x20000000, LENGTH = 4M }\n\
    ENTRY(Reset_Handler)\nSECTIONS {\n .text : { KEEP(*(.isr)) *(.text*) *(.rodata*) *(.init*) *(.fini*) } > FLASH\n\
    .ARM.exidx : { __exidx_start = .; *(.ARM.exidx*) __exidx_end = .; } > FLASH\n\
    .data : { _sdata = .; *(.data*) _edata = .; } > RAM AT > FLASH\n _sidata = LOADADDR(.data);\n\
    .bss : { __bss_start__ = .; *(.bss*) *(COMMON) __bss_end__ = .; } > RAM\n end = .;\n __stack = 0x20400000;\n}\n";

/// Copies data, clears memory, switches the floating-point unit on.
const START: &str = "extern char _sidata[], _sdata[], _edata[], __bss_start__[], __bss_end__[];\n\
    extern int main(void); extern void initialise_monitor_handles(void); extern void exit(int);\n\
    void Reset_Handler(void) { char *s, *d; for (s = _sidata, d = _sdata; d < _edata;) *d++ = *s++;\n\
    for (d = __bss_start__; d < __bss_end__;) *d++ = 0;\n\
    *(volatile unsigned *)0xE000ED88 |= 0xF << 20; __asm volatile(\"dsb\\nisb\"); initialise_monitor_handles(); exit(main()); }\n\
    __attribute__((section(\".isr\"), used)) void *const vectors[2] = {(void *)0x20400000, (void *)Reset_Handler};\n\
    void _init(void) {}\nvoid _fini(void) {}\n";

#[test]
#[ignore = "needs arm-none-eabi-gcc and qemu-system-arm"]
fn a_microcontroller_computes_the_same_bits() {
    let mut system = with_every_pair(HardCase::load("o29_seed_cart").system);
    system.initial = vec![(CoordinateId(0), number("0.5"), Number::ONE)];
    let signals = vec![
        Signal::Harmonic { value: Number::ONE, frequency: number("1.7"), phase: number("0.3"), at: Number::ZERO },
        Signal::Step { value: number("2"), at: number("0.1234") },
    ];
    let mut drives = vec![Vec::new(); system.inputs.len()];
    drives[0] = signals;
    let modes = analysis::modes(&system).expect("modes");
    for precision in [Precision::Double, Precision::Single] {
        let wanted = Options { built_in: true, internal: drives.clone(), precision, ..options("0.01") };
        let discrete = discretise(&system, &modes, &wanted).expect("a system");
        let folder = tempfile::tempdir().expect("a folder");
        let program = Program { step: number("0.01"), samples: 500 };
        write(&folder, &emit::files("rig", &discrete, Language::C, Some(&program)));
        fs::write(folder.path().join("start.c"), START).expect("a file");
        fs::write(folder.path().join("board.ld"), LINKER).expect("a file");
        silently(&folder, "gcc", &["-std=c99", "-O2", "main.c", "rig.c", "-o", "here", "-lm"]);
        let board = ["-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard", "-O2"];
        let compile = [&STRICT[..], &board, &["-c", "rig.c", "-o", "rig.o"]].concat();
        silently(&folder, "arm-none-eabi-gcc", &compile);
        let link = [
            "--specs=rdimon.specs",
            "-nostartfiles",
            "-T",
            "board.ld",
            "start.c",
            "main.c",
            "rig.o",
            "-o",
            "rig.elf",
            "-lm",
        ];
        silently(&folder, "arm-none-eabi-gcc", &[&board[..], &link].concat());
        let here = Command::new(folder.path().join("here")).output().expect("it runs").stdout;
        let machine = ["-M", "mps2-an386", "-cpu", "cortex-m4", "-nographic", "-semihosting", "-kernel", "rig.elf"];
        let there = Command::new("qemu-system-arm")
            .args(machine)
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .output()
            .expect("the emulator starts");
        let messages = String::from_utf8_lossy(&there.stderr);
        let (here, there) = (String::from_utf8_lossy(&here), String::from_utf8_lossy(&there.stdout));
        let differ = here.lines().zip(there.lines()).find(|(a, b)| a != b);
        assert_eq!((differ, here.lines().count()), (None, there.lines().count()), "{precision:?}: {messages}");
        assert_eq!(here.lines().count(), 501);
    }
}
