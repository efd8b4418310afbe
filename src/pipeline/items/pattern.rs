//! Patterns of files' names: `photos/{pose}/{subject}.png`.
//!
//! `*` is any characters, `?` one, `[ab]` one of these, `[!ab]` one of others, `**` any folders (but not those of runs'
//! results), and a place in braces at least one character, which become a key; none of them goes past a `/`. A place
//! that stands twice is the same twice. What begins with a dot is found only where the pattern says the dot. A pattern
//! that ends in `/` finds folders, else files; one that ends in a plain name finds what has it. A name that can be read
//! in two ways is reported, not guessed. Results are sorted by name, whatever the disk's order.

mod walk;

use std::fmt::Write;

use regex_lite::Regex;

use crate::job::Keys;
use crate::words::in_order;

pub(in crate::pipeline) use walk::{Disk, Listed, Match, Tree};

/// A pattern, taken apart.
#[derive(Debug, Clone)]
pub(in crate::pipeline) struct Pattern {
    parts: Vec<Part>,
    /// The places' names in order, each once.
    pub(in crate::pipeline) names: Vec<String>,
    folders: bool,
}

#[derive(Debug, Clone)]
enum Part {
    Plain(String),
    /// `**`
    Folders,
    Wild(Wild),
}

/// A part with places or wildcards.
#[derive(Debug, Clone)]
struct Wild {
    said: String,
    names: Vec<String>,
    /// Each place as short as can be, and as long.
    ways: [Regex; 2],
}

impl Pattern {
    /// Takes a pattern apart.
    pub(in crate::pipeline) fn parse(text: &str) -> Result<Self, String> {
        let (body, folders) = text.strip_suffix('/').map_or((text, false), |body| (body, true));
        let mut parts = Vec::new();
        let mut names: Vec<String> = Vec::new();
        for (k, said) in body.split('/').enumerate() {
            match said {
                "" if k == 0 => parts.push(Part::Plain(String::new())),
                "" | "." => {}
                "**" => parts.push(Part::Folders),
                said if said.contains(['*', '?', '[', ']', '{', '}']) => {
                    let wild = Wild::parse(said)?;
                    names.extend(wild.names.iter().cloned());
                    parts.push(Part::Wild(wild));
                }
                plain => parts.push(Part::Plain(plain.to_owned())),
            }
        }
        if matches!(parts.last(), Some(Part::Folders)) {
            parts.push(Part::Wild(Wild::parse("*")?));
        }
        Ok(Self { parts, names: in_order(names), folders })
    }

    /// The same, which in parts with places or wildcards takes `CSV` for `csv`; none where there is no such part.
    pub(in crate::pipeline) fn in_any_case(&self) -> Option<Self> {
        let mut pattern = self.clone();
        let mut any = false;
        for part in &mut pattern.parts {
            if let Part::Wild(wild) = part {
                let [short, long] = wild.ways.each_ref().map(|way| Regex::new(&format!("(?i){}", way.as_str())).ok());
                wild.ways = [short?, long?];
                any = true;
            }
        }
        any.then_some(pattern)
    }

    /// The same for all endings of a sort of files, without dots; none where it ends in none of these.
    pub(in crate::pipeline) fn with_endings(&self, endings: &[&str]) -> Option<Self> {
        let mut pattern = self.clone();
        let Some(Part::Wild(wild)) = pattern.parts.last_mut() else { return None };
        let (_, own) = wild.said.rsplit_once('.')?;
        if !endings.iter().any(|ending| own.eq_ignore_ascii_case(ending)) {
            return None;
        }
        let all = endings.join("|");
        let [short, long] = wild.ways.each_ref().map(|way| {
            let (name, _) = way.as_str().rsplit_once("\\.")?;
            Regex::new(&format!("{name}\\.(?i:{all})$")).ok()
        });
        wild.ways = [short?, long?];
        Some(pattern)
    }
}

impl Wild {
    fn parse(said: &str) -> Result<Self, String> {
        let (mut short, mut long) = ("^(?s)".to_owned(), "^(?s)".to_owned());
        let mut both = |a: &str, b: &str| {
            short.push_str(a);
            long.push_str(b);
        };
        let mut names = Vec::new();
        let mut rest = said.chars();
        while let Some(c) = rest.next() {
            match c {
                '*' => both(".*?", ".*"),
                '?' => both(".", "."),
                '[' => {
                    let class = until(&mut rest, ']').ok_or_else(|| format!("`{said}`: a [ without its ]"))?;
                    let (not, of) = class.strip_prefix('!').map_or(("", class.as_str()), |of| ("^", of));
                    if of.is_empty() {
                        return Err(format!("`{said}`: [] holds no character; write one, as [ab]"));
                    }
                    let mut escaped = String::new();
                    for c in of.chars() {
                        // A range keeps its dash; all else is the character itself.
                        let _ = if c == '-' || c.is_alphanumeric() {
                            write!(escaped, "{c}")
                        } else {
                            write!(escaped, "\\x{{{:x}}}", u32::from(c))
                        };
                    }
                    let class = format!("[{not}{escaped}]");
                    both(&class, &class);
                }
                '{' => {
                    let name = until(&mut rest, '}').ok_or_else(|| format!("`{said}`: a {{ without its }}"))?;
                    let sound = |c: char| c.is_alphanumeric() || c == '_' || c == '-';
                    if name.is_empty() || !name.chars().all(sound) {
                        return Err(format!("`{said}`: `{{{name}}}` names no key; write one, as {{subject}}"));
                    }
                    if name == "phantom" {
                        return Err(
                            "{phantom} stands only at the beginning: it is the folder of the generated recordings"
                                .to_owned(),
                        );
                    }
                    names.push(name);
                    both("(.+?)", "(.+)");
                }
                ']' | '}' => return Err(format!("`{said}`: a {c} without its beginning")),
                c => {
                    let c = regex_lite::escape(c.encode_utf8(&mut [0; 4]));
                    both(&c, &c);
                }
            }
        }
        let compiled = |text: String| Regex::new(&(text + "$")).map_err(|why| format!("`{said}` is no pattern: {why}"));
        Ok(Self { said: said.to_owned(), names, ways: [compiled(short)?, compiled(long)?] })
    }

    /// The keys that a name gives; two where it can be read in two ways; none where it does not fit.
    fn keys(&self, name: &str) -> Vec<Keys> {
        if name.starts_with('.') && !self.said.starts_with('.') {
            return Vec::new();
        }
        let mut found: Vec<Keys> = self.ways.iter().filter_map(|way| self.keys_in_a_way(way, name)).collect();
        found.dedup();
        found
    }

    fn keys_in_a_way(&self, way: &Regex, name: &str) -> Option<Keys> {
        let captures = way.captures(name)?;
        let mut keys = Keys::default();
        for (key, value) in self.names.iter().zip(captures.iter().skip(1)) {
            let value = value?.as_str();
            if keys.0.insert(key.clone(), value.to_owned()).is_some_and(|earlier| earlier != value) {
                return None;
            }
        }
        Some(keys)
    }
}

/// The characters up to `end`, which is taken too.
fn until(rest: &mut std::str::Chars<'_>, end: char) -> Option<String> {
    let mut taken = String::new();
    loop {
        match rest.next()? {
            c if c == end => return Some(taken),
            c => taken.push(c),
        }
    }
}

#[cfg(test)]
mod tests;
