//! The program's pages in a real browser: keys as a person presses them, text at twice its size, tabs that are hidden.

use serde_json::{Value, json};

use crate::edit::doubtful;
use crate::util::browser::{Browser, ENTER, ESCAPE, RIGHT, SPACE, TAB};
use crate::util::page::{ends, interrupts, until};
use crate::util::{Dir, Json};

/// WCAG 2.2, 2.5.8: the least side of whatever is clicked, CSS pixels.
const LEAST_PX: f64 = 24.0;

/// A set of doubtful nails: one with a plain name, one whose name is a page's worst.
fn doubtful_set(dir: &Dir) {
    ["set/a", "set/b <img src=x onerror=alert(1)>"].iter().for_each(|name| doubtful(dir, name));
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_outlines_are_corrected_by_keyboard_alone() {
    let dir = Dir::new();
    doubtful_set(&dir);
    let (child, page) = dir.page(&["edit", "set"]);
    until("both photographs", || page.hears("edit/state")["open"] == 0);
    let nail = || page.hears("edit/state")["nail"].clone();
    let browser = Browser::open(&page.0, [1200, 800]);
    until("the nail", || browser.text("nail") == "a.png, nail 1 of 1");
    // The canvas has the focus: keys mean the outline at once.
    let before = nail();
    browser.presses(&[RIGHT, RIGHT, "+", "]"]);
    until("four steps", || nail()["axis_deg"] != before["axis_deg"]);
    let after = nail();
    assert!(after["points"] != before["points"] && after["length_px"].number() > before["length_px"].number());
    browser.presses(&[TAB, TAB, "+"]);
    until("a corner", || nail()["corner"].is_u64());
    browser.presses(&["u", "u", "u", "u", "u"]);
    until("the beginning", || nail()["can_undo"] == false);
    // Esc leaves the canvas for the buttons, so that Tab goes through the page.
    browser.presses(&[ESCAPE]);
    let focused = || browser.runs("return document.activeElement.textContent");
    until("the buttons", || focused() == "Accept, next Enter");
    browser.presses(&[TAB]);
    assert_eq!(focused(), "Not a nail X");
    browser.presses(&["?"]);
    until("help", || browser.runs("return document.getElementById('more').open") == true);
    browser.presses(&[ENTER]);
    // Its name is text.
    until("the next", || browser.text("nail").starts_with("b <img src=x onerror=alert(1)>.png"));
    assert_eq!(browser.runs("return document.querySelectorAll('img[onerror]').length"), 0);
    assert_eq!(browser.text("left"), "0 accepted, 1 no nails, 1 doubtful and 0 others left");
    browser.presses(&["p"]);
    until("the first again", || browser.text("nail") == "a.png, nail 1 of 1, not a nail");
    browser.presses(&["u"]);
    until("nothing decided", || page.hears("edit/state")["rejected"] == 0);
    browser.runs("document.getElementById('field').focus()");
    browser.presses(&[ENTER]);
    until("the file", || dir.path("set/a.json").exists() && browser.text("left").starts_with("1 accepted"));
    // Single keys can be turned off; the canvas keeps its own.
    browser.runs("document.getElementById('shortcuts').click(); document.querySelector('#decide button').focus()");
    browser.presses(&["x"]);
    assert_eq!(page.hears("edit/state")["rejected"], 0);
    browser.runs("document.getElementById('field').focus()");
    browser.presses(&["x"]);
    until("rejected", || page.hears("edit/state")["rejected"] == 1);
    drop(browser);
    interrupts(&child);
    assert_eq!(ends(child), 0);
    let saved = lunula::labelme::LabelMe::read(&dir.path("set/a.json")).expect("LabelMe");
    assert_eq!(saved.shapes[0].label, "nail");
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_a_pointer_and_a_second_page_do_the_same() {
    let dir = Dir::new();
    doubtful_set(&dir);
    let (mut child, page) = dir.page(&["edit", "set"]);
    let nail = || page.hears("edit/state")["nail"].clone();
    let pages = [(); 2].map(|()| Browser::open(&page.0, [900, 700]));
    for browser in &pages {
        until("the nail", || browser.text("nail").starts_with("a.png"));
    }
    // A drag from within the outline moves all of it.
    let drag = "const f = document.getElementById('field'), b = f.getBoundingClientRect();
        const at = (kind, dx) => f.dispatchEvent(new PointerEvent(kind, { pointerId: 1, button: 0, bubbles: true,
          clientX: b.left + b.width / 2 + dx, clientY: b.top + b.height / 2 }));
        f.setPointerCapture = () => {};
        at('pointerdown', 0); at('pointermove', 20); at('pointermove', 40); at('pointerup', 40);";
    let before = nail();
    pages[0].runs(drag);
    until("the drag", || nail()["points"] != before["points"]);
    let x = |nail: &Value| nail["points"][0][0].number();
    assert!(x(&nail()) > x(&before) + 1.0);
    // The other page shows it, and goes on from there.
    until("the other", || pages[1].text("size") == pages[0].text("size"));
    pages[1].presses(&[ENTER]);
    for browser in &pages {
        until("the next", || browser.text("nail").starts_with("b "));
    }
    drop(pages);
    let _ = (child.kill(), child.wait());
}

/// What is wrong with a page in a window of this size, in words.
fn faults(browser: &Browser) -> Vec<String> {
    let script = format!(
        "const all = [...document.querySelectorAll('button, summary, a, select, input')]
           .filter((e) => e.checkVisibility());
         const small = all.filter((e) => {{
           const b = (e.closest('label') || e).getBoundingClientRect();
           return b.height < {LEAST_PX} || b.width < {LEAST_PX};
         }}).map((e) => `small: ${{e.outerHTML}}`);
         const across = document.documentElement.scrollWidth;
         const wide = across > innerWidth + 1 ? [`${{across}} px wide`] : [];
         const moving = document.getAnimations().map(() => 'moves by itself');
         return [...small, ...wide, ...moving];"
    );
    let found = browser.runs(&script);
    found.list().iter().map(|fault| fault.words().to_owned()).collect()
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_pages_fit_at_twice_the_size_and_what_is_clicked_is_large_enough() {
    let dir = Dir::new();
    doubtful_set(&dir);
    dir.nail("other/a");
    dir.lunula(&["photos", "other", "--out", "out"]).expect(0);
    let (mut edit, outlines) = dir.page(&["edit", "set", "--results", "out"]);
    let source = ["--source", "phantom:subject", "--out", "r.csv"];
    let (mut prompt, prompter) = dir.page(&[&["prompt"], &source[..]].concat());
    // 1280 x 800 at 200 %.
    for (page, name, ready) in [
        (&outlines, "", "return document.getElementById('nail').textContent.length > 3"),
        (&outlines, "results", "return document.querySelectorAll('#runs button').length > 0"),
        (&prompter, "", "return document.querySelectorAll('canvas').length > 0"),
        (&prompter, "live", "return document.querySelectorAll('canvas').length > 1"),
    ] {
        let browser = Browser::open(&page.0, [640, 400]);
        until("its links", || browser.runs("return document.querySelectorAll('nav a').length") == 2);
        if !name.is_empty() {
            browser.runs(&format!("document.querySelector('nav a[href={name}]').click()"));
        }
        until(name, || browser.runs(ready) == true);
        assert_eq!(faults(&browser), [""; 0], "{} {name}", page.0);
        assert_eq!(browser.runs("return document.querySelectorAll('nav a[aria-current]').length"), 1, "{name}");
    }
    for child in [&mut edit, &mut prompt] {
        let _ = (child.kill(), child.wait());
    }
}

#[test]
#[ignore = "needs Chromium: `make test` runs it where that is installed"]
fn in_browser_a_hidden_tab_and_a_page_loaded_again_pause_the_prompter() {
    let dir = Dir::new();
    dir.write("p.toml", "[[step]]\nkind = \"spiral\"\nname = \"force\"\nseconds = 60\n");
    let (child, page) = dir.page(&["prompt", "p.toml", "--source", "phantom:subject", "--out", "r.csv"]);
    let browser = Browser::open(&page.0, [1200, 800]);
    let phase = || page.hears("prompt/state")["phase"].clone();
    until("a page that looks", || browser.runs("return document.querySelectorAll('canvas').length > 0") == true);
    std::thread::sleep(std::time::Duration::from_secs(2));
    browser.presses(&[SPACE]);
    until("it runs", || phase() == "running");
    std::thread::sleep(std::time::Duration::from_secs(2));
    browser.opens_another_tab();
    until("it pauses", || phase() == "paused");
    browser.goes_back_to_the_first_tab();
    browser.presses(&[SPACE]);
    until("it goes on", || phase() == "running");
    std::thread::sleep(std::time::Duration::from_secs(1));
    browser.runs("location.reload()");
    until("it pauses", || phase() == "paused");
    drop(browser);
    interrupts(&child);
    assert_ne!(ends(child), 2);
    let report = dir.parsed("r.run.json");
    let events: Vec<&str> = report["turns"].list().iter().map(|turn| turn["event"].words()).collect();
    assert_eq!(events.iter().filter(|event| **event == "paused").count(), 2, "{events:?}");
    assert_eq!(report["frames"]["mistaken"], json!(0));
}
