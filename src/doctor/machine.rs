//! Threads and memory.

use std::thread::available_parallelism;

use super::Check;

/// Less makes large videos and sets of photographs slow, bytes.
const LITTLE: u64 = 1 << 30;

/// Threads and memory that this process may use.
pub(super) fn examine() -> Vec<Check> {
    let threads = match available_parallelism() {
        Ok(threads) => Check::good("threads", format!("{threads}; --threads N takes fewer")),
        Err(why) => Check::note("threads", format!("not known ({why})"), "tell their number with --threads"),
    };
    vec![
        threads,
        memory(available(
            &read("/proc/meminfo"),
            &read("/sys/fs/cgroup/memory.max"),
            &read("/sys/fs/cgroup/memory.current"),
        )),
    ]
}

/// A file of the system's; empty where there is none, as on other systems.
fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

fn memory(bytes: Option<u64>) -> Check {
    match bytes {
        None => Check::note("memory", "not known", "tell `lunula run` how much it may use with --memory"),
        Some(bytes) if bytes < LITTLE => {
            Check::note("memory", format!("{} free", gib(bytes)), "end other programs, or use fewer --threads")
        }
        Some(bytes) => Check::good("memory", format!("{} free", gib(bytes))),
    }
}

/// Bytes in words.
pub(super) fn gib(bytes: u64) -> String {
    format!("{:.1} GiB", bytes as f64 / (1u64 << 30) as f64)
}

/// Bytes that are free: of the machine, or of the group of processes that this one was put into, whichever is less.
fn available(meminfo: &str, most: &str, used: &str) -> Option<u64> {
    let kibibytes = meminfo
        .lines()
        .find_map(|line| line.strip_prefix("MemAvailable:")?.trim().strip_suffix("kB")?.trim().parse::<u64>().ok());
    let of_group = most.trim().parse::<u64>().ok().map(|most| most.saturating_sub(used.trim().parse().unwrap_or(0)));
    match (kibibytes.map(|k| k * 1024), of_group) {
        (Some(machine), Some(group)) => Some(machine.min(group)),
        (machine, group) => machine.or(group),
    }
}

#[cfg(test)]
mod tests {
    use super::super::State;
    use super::*;

    const MEMINFO: &str = "MemTotal:       24600000 kB\nMemFree:         900 kB\nMemAvailable:    4194304 kB\n";

    #[test]
    fn a_group_s_limit_counts_where_it_is_less() {
        assert_eq!(available(MEMINFO, "max\n", "17\n"), Some(4 << 30));
        assert_eq!(available(MEMINFO, "1073741824\n", "1073741800\n"), Some(24));
        assert_eq!(available(MEMINFO, "10\n", "17\n"), Some(0));
        assert_eq!(available("", "", ""), None);
    }

    #[test]
    fn little_memory_and_unknown_memory_are_noted() {
        assert_eq!(memory(Some(4 << 30)).state, State::Good);
        assert_eq!(memory(Some(1 << 20)).state, State::Note);
        assert_eq!(memory(None).state, State::Note);
    }
}
