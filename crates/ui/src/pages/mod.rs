//! The pages, as they are in this folder: built into the program, nothing of them from elsewhere.

/// A file of the pages.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asset {
    pub(crate) path: &'static str,
    pub(crate) kind: &'static str,
    pub(crate) bytes: &'static [u8],
}

const HTML: &str = "text/html; charset=utf-8";
const SCRIPT: &str = "text/javascript; charset=utf-8";
const STYLE: &str = "text/css; charset=utf-8";

/// Files that every page has.
pub(crate) const COMMON: [Asset; 2] = [
    Asset { path: "/common.js", kind: SCRIPT, bytes: include_bytes!("common.js") },
    Asset { path: "/style.css", kind: STYLE, bytes: include_bytes!("style.css") },
];
/// The outlines of a set.
pub(crate) const EDIT: [Asset; 4] = [
    Asset { path: "/", kind: HTML, bytes: include_bytes!("edit/page.html") },
    Asset { path: "/edit.js", kind: SCRIPT, bytes: include_bytes!("edit/edit.js") },
    Asset { path: "/keys.js", kind: SCRIPT, bytes: include_bytes!("edit/keys.js") },
    Asset { path: "/edit.css", kind: STYLE, bytes: include_bytes!("edit/edit.css") },
];
/// A session of the sensor.
pub(crate) const LIVE: [Asset; 2] = [
    Asset { path: "/", kind: HTML, bytes: include_bytes!("live/page.html") },
    Asset { path: "/live.js", kind: SCRIPT, bytes: include_bytes!("live/live.js") },
];
/// The list of results.
pub(crate) const RESULTS: [Asset; 2] = [
    Asset { path: "/", kind: HTML, bytes: include_bytes!("results.html") },
    Asset { path: "/results.js", kind: SCRIPT, bytes: include_bytes!("results.js") },
];
/// The prompter.
pub(crate) const PROMPT: [Asset; 5] = [
    Asset { path: "/", kind: HTML, bytes: include_bytes!("prompt/page.html") },
    Asset { path: "/prompt.js", kind: SCRIPT, bytes: include_bytes!("prompt/prompt.js") },
    Asset { path: "/draw.js", kind: SCRIPT, bytes: include_bytes!("prompt/draw.js") },
    Asset { path: "/clock.js", kind: SCRIPT, bytes: include_bytes!("prompt/clock.js") },
    Asset { path: "/prompt.css", kind: STYLE, bytes: include_bytes!("prompt/prompt.css") },
];

#[cfg(test)]
mod tests {
    use super::*;

    /// All pages together, bytes.
    const MOST: usize = 200 * 1024;

    #[test]
    fn the_pages_are_small_and_ask_for_nothing_elsewhere() {
        let all = || COMMON.iter().chain(&RESULTS).chain(&LIVE).chain(&PROMPT).chain(&EDIT);
        assert!(all().map(|asset| asset.bytes.len()).sum::<usize>() <= MOST);
        for asset in all() {
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
