//! Tasks' names, which are folders' names: the stage's, then the values of its keys.

use crate::job::Keys;

/// Longer values make names that some disks refuse.
const LONGEST: usize = 120;

/// The name of a stage's task; a key that an item does not have is `_`, so that no name is another's beginning.
///
/// # Errors
/// A value that is too long.
pub(super) fn task_id(stage: &str, names: &[String], keys: &Keys) -> Result<String, String> {
    let mut id = stage.to_owned();
    for name in names {
        let value = keys.get(name).unwrap_or("");
        if value.len() > LONGEST {
            let begins: String = value.chars().take(20).collect();
            return Err(format!(
                "`{name}` is {} bytes long (`{begins}..`), too long for a folder's name; shorten it",
                value.len()
            ));
        }
        id.push('/');
        id.push_str(&safe(value));
    }
    Ok(id)
}

/// A value as a folder's name: letters, digits and a few signs stay, all else is `_`.
fn safe(value: &str) -> String {
    let kept = |c: char| if c.is_alphanumeric() || "-_.+=@,".contains(c) { c } else { '_' };
    let safe: String = value.chars().map(kept).collect();
    match safe.as_bytes() {
        [] => "_".to_owned(),
        // A name of dots alone leads elsewhere; one that begins with a dot is hidden.
        [b'.', rest @ ..] => format!("_{}", String::from_utf8_lossy(rest)),
        _ => safe,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn id(value: &str) -> String {
        let keys = Keys([("s".to_owned(), value.to_owned())].into());
        task_id("angles", &["s".to_owned()], &keys).unwrap()
    }

    #[test]
    fn values_are_safe_as_folders() {
        let cases = [
            ("S01", "angles/S01"),
            ("a/b", "angles/a_b"),
            ("..", "angles/_."),
            (".", "angles/_"),
            ("", "angles/_"),
            (".hidden", "angles/_hidden"),
            ("Müller 日本", "angles/Müller_日本"),
            ("1.5", "angles/1.5"),
            ("a\\b:c*", "angles/a_b_c_"),
            ("a\nb", "angles/a_b"),
        ];
        for (value, expected) in cases {
            assert_eq!(id(value), expected, "{value:?}");
        }
    }

    #[test]
    fn a_missing_key_keeps_its_place_and_a_long_one_is_refused() {
        let names = ["a".to_owned(), "b".to_owned()];
        let keys = Keys([("b".to_owned(), "1".to_owned())].into());
        assert_eq!(task_id("x", &names, &keys).unwrap(), "x/_/1");
        let long = Keys([("a".to_owned(), "ä".repeat(61))].into());
        assert!(task_id("x", &names, &long).unwrap_err().contains("122 bytes"));
    }
}
