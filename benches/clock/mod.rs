//! The clock of the benchmarks.

use std::time::Instant;

/// Processor time if the kernel reports it, so that a busy machine does not matter; otherwise wall-clock time.
pub struct Clock {
    wall: Instant,
    processor: Option<f64>,
}

impl Clock {
    pub fn start() -> Clock {
        Clock { wall: Instant::now(), processor: processor_seconds() }
    }

    pub fn seconds(&self) -> f64 {
        let processor = self.processor.and_then(|start| Some(processor_seconds()? - start));
        processor.unwrap_or_else(|| self.wall.elapsed().as_secs_f64())
    }
}

/// Nanoseconds on a processor: the first field of /proc/self/schedstat (Documentation/scheduler/sched-stats.rst).
fn processor_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}
