//! What a job says in the words of the command line, in those of a pipeline file: `--full-scale LOW,HIGH` is the key
//! `full_scale` there.

use crate::job::Made;

/// A text with keys in place of options.
pub(in crate::pipeline) fn in_keys(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("--") {
        let (before, from) = rest.split_at(at);
        out += before;
        let word = &from[2..];
        let name = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let word = &word[..word.find(|c| !name(c)).unwrap_or(word.len())];
        let word = word.trim_end_matches('-');
        let last = out.chars().next_back();
        // Not within a name: `a--b.csv`, `/--x/`.
        let begins = last.is_none_or(|c| !(c.is_alphanumeric() || matches!(c, '-' | '_' | '.' | '/' | '\\')));
        // A command stays one.
        let in_command = out.split('`').skip(1).step_by(2).last().is_some_and(|span| span.starts_with("lunula "))
            && out.matches('`').count() % 2 == 1;
        if !(begins && !in_command && word.starts_with(|c: char| c.is_ascii_lowercase())) {
            out += "--";
            rest = &from[2..];
            continue;
        }
        let quote = if last == Some('`') { "" } else { "`" };
        out += &format!("{quote}{}{quote}", word.replace('-', "_"));
        rest = &from[2 + word.len()..];
    }
    out + rest
}

/// The same of all of a job's texts for people.
pub(in crate::pipeline) fn made_in_keys(made: &mut Made) {
    let lists = [&mut made.left_out, &mut made.warnings, &mut made.notes, &mut made.failed];
    lists.into_iter().flatten().for_each(|text| *text = in_keys(text));
    for list in ["warnings", "left_out"] {
        for text in made.report.get_mut(list).and_then(|list| list.as_array_mut()).into_iter().flatten() {
            if let serde_json::Value::String(text) = text {
                *text = in_keys(text);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_become_keys_and_names_of_files_stay() {
        for (said, key) in [
            (
                "`lunula posture V --suggest` measures; see --start",
                "`lunula posture V --suggest` measures; see `start`",
            ),
            (
                "correct it, or leave out such rows with --drop-invalid",
                "correct it, or leave out such rows with `drop_invalid`",
            ),
            ("--full-scale LOW,HIGH says where", "`full_scale` LOW,HIGH says where"),
            ("(--params, --set)", "(`params`, `set`)"),
            ("say which, as in --columns \"P1=a\"", "say which, as in `columns` \"P1=a\""),
            ("`--by` is", "`by` is"),
            ("/data/a--b.csv: no", "/data/a--b.csv: no"),
            ("a -- b --", "a -- b --"),
        ] {
            assert_eq!(in_keys(said), key);
        }
    }
}
