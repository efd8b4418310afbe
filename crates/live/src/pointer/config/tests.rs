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
fn a_wrong_key_or_type_is_reported_with_its_line_and_wrong_values_together() {
    for (text, words) in [
        ("click_n = 2.0\nclik_n = 2.0\n", ["line 2", "unknown field `clik_n`, expected one of `mode`, "]),
        ("\nmode = \"speed\"\n", ["line 2", "unknown variant `speed`, expected `velocity` or `position`"]),
        ("touch_n = \"light\"\n", ["line 1", "invalid type: string \"light\", expected f64"]),
        ("[zero]\nafter_s = 1\n", ["line 1", "invalid type: map, expected a boolean"]),
    ] {
        let got = Config::from_toml(text).unwrap_err().to_string();
        assert!(words.iter().all(|words| got.contains(words)), "{got}");
    }
    let got = faults("release_n = 1.9\ncap_px_per_s = nan\n");
    assert_eq!(got.len(), 2, "{got:?}");
    assert!(got[0].starts_with("cap_px_per_s = NaN: choose above 0 and up to 1000000 px/s"), "{got:?}");
    assert!(got[1].starts_with("release_n = 1.9 must be below click_n = 1.8"), "{got:?}");
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
    for (text, line) in [("click_n = 2.0\nrelease_n 1.0\n", 2), ("click_n = 2.0\nclick_n = 3.0\n", 2), ("x = \u{1}", 1)]
    {
        assert!(faults(text)[0].contains(&format!("at line {line}, column")), "{text}");
    }
}

#[test]
fn every_number_has_bounds() {
    let table = toml::Table::try_from(Config::default()).unwrap();
    let numbers: Vec<&String> = table.iter().filter(|(_, value)| value.is_float()).map(|(key, _)| key).collect();
    assert_eq!(numbers.len(), 29);
    for key in numbers {
        for value in ["nan", "inf", "-inf", "-1000.0", "1e300"] {
            let got = faults(&format!("{key} = {value}\n"));
            assert!(got.iter().any(|line| line.starts_with(&format!("{key} = "))), "{key} {value}: {got:?}");
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
    let faults = config.check().unwrap_err().0;
    let keys: Vec<&str> = faults.iter().filter_map(|fault| fault.split(' ').next()).collect();
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
