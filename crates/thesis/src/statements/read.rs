//! Reads the statements as they are written in `statements.toml`, and checks them.

use std::collections::{BTreeMap, BTreeSet};

use serde::Deserialize;
use thiserror::Error;
use toml::{Table, Value};

use super::test::{Condition, Relation, expanded};
use super::{Kind, Quantity, Statement, Statements};

/// Why there are no statements.
#[derive(Debug, Error)]
pub enum StatementsError {
    /// The file has another form.
    #[error("statements.toml: {0}")]
    Form(#[from] toml::de::Error),
    /// Each fault names its statement or quantity.
    #[error("statements.toml: {}", .0.join("; "))]
    Faults(Vec<String>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    source: Vec<WrittenSource>,
    statement: Vec<WrittenStatement>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenSource {
    from: String,
    /// Name, unit, meaning.
    quantities: Vec<[String; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenStatement {
    id: String,
    section: String,
    #[serde(default)]
    figure: String,
    sentence: String,
    kind: Kind,
    #[serde(default)]
    note: String,
    test: Vec<Table>,
}

impl Statements {
    /// Those of the thesis.
    ///
    /// # Errors
    /// The file that comes with the program is wrong, which a test excludes.
    pub fn of_the_thesis() -> Result<Self, StatementsError> {
        Self::read(include_str!("statements.toml"))
    }

    /// Those of a file's text.
    ///
    /// # Errors
    /// Another form; a quantity that is unknown, declared twice or unused; a name that occurs twice; a condition
    /// without exactly one relation.
    pub fn read(text: &str) -> Result<Self, StatementsError> {
        let written: Written = toml::from_str(text)?;
        let mut faults = Vec::new();
        let quantities = quantities(written.source, &mut faults);
        let units: BTreeMap<&str, &str> = quantities.iter().map(|one| (&*one.name, &*one.unit)).collect();
        let all: Vec<Statement> =
            written.statement.into_iter().map(|one| statement(one, &units, &mut faults)).collect();
        let mut ids = BTreeSet::new();
        let doubled = all.iter().filter(|one| !ids.insert(&one.id));
        faults.extend(doubled.map(|one| format!("{}: the name occurs twice", one.id)));
        let used: BTreeSet<&str> = all.iter().flat_map(Statement::names).collect();
        let unused = units.keys().filter(|name| !used.contains(**name));
        faults.extend(unused.map(|name| format!("{name}: no statement uses this quantity")));
        if faults.is_empty() { Ok(Self { all, quantities }) } else { Err(StatementsError::Faults(faults)) }
    }
}

fn quantities(sources: Vec<WrittenSource>, faults: &mut Vec<String>) -> Vec<Quantity> {
    let (mut all, mut seen) = (Vec::new(), BTreeSet::new());
    for WrittenSource { from, quantities } in sources {
        for [pattern, unit, means] in quantities {
            let names = expanded(&pattern).unwrap_or_else(|why| {
                faults.push(why);
                Vec::new()
            });
            for (name, _) in names {
                if !seen.insert(name.clone()) {
                    faults.push(format!("{name}: the quantity is declared twice"));
                }
                all.push(Quantity { name, unit: unit.clone(), means: means.clone(), from: from.clone() });
            }
        }
    }
    all
}

fn statement(written: WrittenStatement, units: &BTreeMap<&str, &str>, faults: &mut Vec<String>) -> Statement {
    let WrittenStatement { id, section, figure, sentence, kind, note, test } = written;
    let (mut words, mut conditions) = (Vec::new(), Vec::new());
    let mut own = Vec::new();
    for table in test {
        match condition(table, units) {
            Ok((said, all)) => {
                words.push(said);
                conditions.extend(all);
            }
            Err(why) => own.push(why),
        }
    }
    for (what, empty) in [
        ("section", section.is_empty()),
        ("sentence", sentence.is_empty()),
        ("test", conditions.is_empty() && own.is_empty()),
    ] {
        if empty {
            own.push(format!("`{what}` is empty"));
        }
    }
    faults.extend(own.into_iter().map(|what| format!("{id}: {what}")));
    Statement { id, section, figure, sentence, kind, note, test: words.join("; "), conditions }
}

/// A condition's words, and what it stands for.
fn condition(mut table: Table, units: &BTreeMap<&str, &str>) -> Result<(String, Vec<Condition>), String> {
    let Some(Value::String(quantity)) = table.remove("quantity") else {
        return Err("a condition names no `quantity`".to_owned());
    };
    if table.len() != 1 {
        let named: Vec<&str> = table.keys().map(String::as_str).collect();
        return Err(match named.len() {
            0 => format!("{quantity}: there is no threshold; give one relation"),
            _ => format!("{quantity}: {} are several relations; give one", named.join(", ")),
        });
    }
    let relation = Relation::deserialize(Value::Table(table)).map_err(|why| format!("{quantity}: {why}"))?;
    let all = Condition::all(&quantity, &relation)?;
    if all.is_empty() {
        return Err(format!("{quantity}: it is compared with nothing"));
    }
    let unknown: BTreeSet<&str> =
        all.iter().flat_map(Condition::names).filter(|name| !units.contains_key(name)).collect();
    if !unknown.is_empty() {
        let unknown: Vec<&str> = unknown.into_iter().collect();
        return Err(format!("the quantity {} is unknown", unknown.join(", ")));
    }
    let unit = all[0].unit(units);
    Ok((format!("{quantity} {}", relation.words(unit)), all))
}
