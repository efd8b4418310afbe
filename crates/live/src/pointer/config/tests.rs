use super::*;

/// The faults as they are shown, one a line.
fn faults(text: &str) -> Vec<String> {
    Config::from_toml(text).unwrap_err().to_string().lines().map(str::to_owned).collect()
}

#[test]
fn an_empty_file_is_the_default_and_the_default_can_work() {
    assert_eq!(Config::from_toml("").unwrap(), Config::default());
    Config::default().check().unwrap();
    let text = toml::to_string(&Config::default()).unwrap();
    assert_eq!(Config::from_toml(&text).unwrap(), Config::default());
}

#[test]
fn keys_are_read() {
    let text = "# a mouse\nmode = \"position\"\nclick = 'tap'\nclick_n = 2\nscroll = true\ndead_zone_n = 0\n";
    let config = Config::from_toml(text).unwrap();
    let expected = Config {
        mode: Mode::Position,
        click: Click::Tap,
        click_n: 2.0,
        scroll: true,
        dead_zone_n: 0.0,
        ..Config::default()
    };
    assert_eq!(config, expected);
}

#[test]
fn all_faults_of_a_file_are_reported_with_their_lines() {
    let text = "clik_n = 2.0\n\nmode = \"speed\"\nrelease_n = 1.9\ntouch_n = \"light\"\ncap_px_per_s = nan\n\
                velocity = 3\n[zero]\nafter_s = 1\n";
    let got = faults(text);
    let expected = [
        "line 1: unknown key `clik_n`; did you mean `click_n`?",
        "line 3: `mode`: unknown variant `speed`, expected `velocity` or `position`",
        "line 4: release_n = 1.9 must be below click_n = 1.8",
        "line 5: `touch_n`: invalid type: string \"light\", expected f64",
        "line 6: cap_px_per_s = NaN: choose above 0 and up to 1000000 px/s",
        "line 7: unknown key `velocity`; known: beta, cap_px_per_s, click,",
        "line 8: `zero`: table where a number or a word is expected",
    ];
    assert_eq!(got.len(), expected.len(), "{got:#?}");
    for (got, expected) in got.iter().zip(expected) {
        assert!(got.starts_with(expected), "{got}\n{expected}");
    }
}

#[test]
fn milliseconds_are_refused() {
    for key in ["rise_time_s", "lock_s", "settle_s", "tap_max_s", "scroll_after_s", "zero_after_s"] {
        let got = faults(&format!("{key} = 100\n"));
        assert!(got.len() == 1 && got[0].contains(&format!("{key} = 100: choose")), "{got:?}");
        assert!(got[0].ends_with("10 s"), "{got:?}");
    }
}

#[test]
fn text_that_is_no_toml_is_reported_with_its_line() {
    let got = faults("click_n = 2.0\nrelease_n 1.0\n");
    assert!(got.len() == 1 && got[0].starts_with("line 2: not TOML: "), "{got:?}");
    let got = faults("click_n = 2.0\nclick_n = 3.0\n");
    assert!(got[0].starts_with("line 2: not TOML: duplicate key"), "{got:?}");
    assert!(faults("x = \u{1}")[0].starts_with("line 1: "));
}

#[test]
fn many_faults_are_counted() {
    let text: String = (0..1000).map(|k| format!("key{k} = 1\n")).collect();
    let got = faults(&text);
    assert_eq!((got.len(), got[100].as_str()), (101, "900 more faults are not named; correct these first"));
}

#[test]
fn every_number_has_bounds() {
    let table = toml::Table::try_from(Config::default()).unwrap();
    let numbers: Vec<&String> = table.iter().filter(|(_, value)| value.is_float()).map(|(key, _)| key).collect();
    assert_eq!(numbers.len(), 29);
    for key in numbers {
        for value in ["nan", "inf", "-inf", "-1000.0", "1e300"] {
            let got = faults(&format!("{key} = {value}\n"));
            assert!(got.iter().any(|line| line.starts_with(&format!("line 1: {key} = "))), "{key} {value}: {got:?}");
        }
    }
}

#[test]
fn values_that_contradict_each_other_are_reported_together() {
    let config = Config {
        touch_release_n: 0.4,
        click_n: 0.2,
        release_n: 0.25,
        gain_high_px_per_s_per_n: 1.0,
        ..Config::default()
    };
    let keys: Vec<String> = config.check().unwrap_err().0.into_iter().filter_map(|fault| fault.key).collect();
    assert_eq!(keys, ["touch_release_n", "release_n", "release_n", "click_n", "gain_high_px_per_s_per_n"]);
    // Taps do not ask for the keys of presses.
    Config { click: Click::Tap, click_n: 0.2, release_n: 0.25, ..Config::default() }.check().unwrap();
}

/// The book's table has every key with its default.
#[test]
fn the_book_has_every_key_and_its_default() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/src/jobs/mouse.md");
    let page = std::fs::read_to_string(page).unwrap();
    let table = toml::Table::try_from(Config::default()).unwrap();
    let rows = page.lines().filter(|line| line.starts_with("| `")).count();
    assert_eq!(rows, table.len());
    for (key, value) in table {
        let start = format!("| `{key}` | {} |", value.to_string().replace('"', "`"));
        assert!(page.lines().any(|line| line.starts_with(&start)), "no row `{start}`");
    }
}
