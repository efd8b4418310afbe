//! The pages, as they are in this folder: built into the program, nothing of them from elsewhere.

/// A file of the pages.
pub(crate) struct Asset {
    pub(crate) path: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) bytes: &'static [u8],
}

/// All of them.
pub(crate) const ASSETS: [Asset; 3] = [
    Asset { path: "/", kind: "text/html; charset=utf-8", bytes: include_bytes!("index.html") },
    Asset { path: "/app.js", kind: "text/javascript; charset=utf-8", bytes: include_bytes!("app.js") },
    Asset { path: "/style.css", kind: "text/css; charset=utf-8", bytes: include_bytes!("style.css") },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// All pages together, bytes.
    const MOST: usize = 200 * 1024;

    #[test]
    fn the_pages_are_small_and_ask_for_nothing_elsewhere() {
        assert!(ASSETS.iter().map(|asset| asset.bytes.len()).sum::<usize>() <= MOST);
        for asset in &ASSETS {
            let text = std::str::from_utf8(asset.bytes).unwrap();
            assert!(
                !text.contains("://") && !text.contains("innerHTML") && !text.contains("<script>"),
                "{}",
                asset.path
            );
            assert!(!text.contains(" style=") && !text.contains(" onclick="), "{}: the policy forbids it", asset.path);
        }
    }
}
