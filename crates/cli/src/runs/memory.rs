//! How much memory and how many threads there are.

/// A size in bytes: `4GB`, `500MB`, `1.5GB`, `65536`; a thousand of one is one of the next, 1024 with `i`: `4GiB`.
pub(crate) fn parse(text: &str) -> Result<u64, String> {
    let refused = || format!("`{text}` is no size; write it as 4GB, 500MB or 4GiB");
    let end = text.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(text.len());
    let number: f64 = text[..end].parse().map_err(|_| refused())?;
    let unit: f64 = match text[end..].trim().to_ascii_lowercase().as_str() {
        "" | "b" => 1.0,
        "k" | "kb" => 1e3,
        "m" | "mb" => 1e6,
        "g" | "gb" => 1e9,
        "t" | "tb" => 1e12,
        "kib" => 1024.0,
        "mib" => 1024.0 * 1024.0,
        "gib" => 1024.0 * 1024.0 * 1024.0,
        _ => return Err(refused()),
    };
    let bytes = number * unit;
    if (1.0..=1e18).contains(&bytes) { Ok(bytes as u64) } else { Err(refused()) }
}

/// Three quarters of what the system has free; 4 GB where that is not known.
pub(crate) fn free() -> u64 {
    lunula::doctor::free_memory().map_or(4_000_000_000, |bytes| bytes / 4 * 3)
}

/// As many as there are cores.
pub(crate) fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_with_their_units() {
        assert_eq!(parse("4GB"), Ok(4_000_000_000));
        assert_eq!(parse("1.5 gb"), Ok(1_500_000_000));
        assert_eq!(parse("2MiB"), Ok(2 << 20));
        assert_eq!(parse("4096"), Ok(4096));
        for bad in ["", "GB", "0", "-1GB", "4XB", "1e99GB", "nan"] {
            assert!(parse(bad).is_err(), "{bad}");
        }
    }
}
