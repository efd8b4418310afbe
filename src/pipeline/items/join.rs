//! The natural join of relations: every combination of items that say the same where they speak of the same.

use std::collections::{BTreeSet, HashMap};

use super::Relation;
use crate::job::Keys;
use crate::words::in_order;

/// Combinations of one item of each relation.
#[derive(Debug, Default)]
pub(in crate::pipeline) struct JoinedRows {
    /// The keys' names, in the order of the relations.
    pub(in crate::pipeline) names: Vec<String>,
    /// Each combination's keys, and the position of its item in each relation.
    pub(in crate::pipeline) rows: Vec<(Keys, Vec<usize>)>,
    /// What found no partner.
    pub(in crate::pipeline) unjoined: Vec<Unjoined>,
}

/// Items of a relation for which another has none.
#[derive(Debug, PartialEq, Eq)]
pub(in crate::pipeline) struct Unjoined {
    pub(in crate::pipeline) of: usize,
    /// Which relation has none.
    pub(in crate::pipeline) lacks: usize,
    pub(in crate::pipeline) keys: Vec<Keys>,
}

/// Joins relations from the first to the last.
///
/// # Errors
/// Two of them that both have keys and none in common, by position.
pub(in crate::pipeline) fn join(relations: &[&Relation]) -> Result<JoinedRows, (usize, usize)> {
    let mut joined = JoinedRows { rows: vec![(Keys::default(), Vec::new())], ..JoinedRows::default() };
    for (at, relation) in relations.iter().enumerate() {
        if !relation.names.iter().any(|name| joined.names.contains(name))
            && !relation.names.is_empty()
            && !joined.names.is_empty()
        {
            let other = relations[..at].iter().position(|earlier| !earlier.names.is_empty()).unwrap_or(0);
            return Err((other, at));
        }
        let index = Index::new(relation, &joined.names);
        let mut used = vec![false; relation.items.len()];
        let mut rows = Vec::new();
        let mut alone = BTreeSet::new();
        for (keys, picks) in &joined.rows {
            let mut found = false;
            for place in index.find(keys) {
                found = true;
                used[place] = true;
                rows.push((keys.and(&relation.items[place].keys), picks.iter().copied().chain([place]).collect()));
            }
            if !found && at > 0 {
                alone.insert(keys.clone());
            }
        }
        if !alone.is_empty() {
            joined.unjoined.push(Unjoined { of: 0, lacks: at, keys: alone.into_iter().collect() });
        }
        let unused: BTreeSet<Keys> =
            relation.items.iter().zip(&used).filter(|(_, used)| !**used).map(|(item, _)| item.keys.clone()).collect();
        if !unused.is_empty() && at > 0 {
            joined.unjoined.push(Unjoined { of: at, lacks: 0, keys: unused.into_iter().collect() });
        }
        joined.rows = rows;
        joined.names = in_order(joined.names.iter().chain(&relation.names).cloned());
    }
    Ok(joined)
}

/// Items by the values of the keys that they share with others.
pub(in crate::pipeline) struct Index<'a> {
    relation: &'a Relation,
    shared: Vec<&'a str>,
    by_values: HashMap<Vec<&'a str>, Vec<usize>>,
    /// Those that don't say all of the shared keys.
    loose: Vec<usize>,
}

impl<'a> Index<'a> {
    pub(in crate::pipeline) fn new(relation: &'a Relation, names: &[String]) -> Self {
        let shared: Vec<&str> = relation.names.iter().filter(|name| names.contains(name)).map(String::as_str).collect();
        let mut by_values: HashMap<Vec<&str>, Vec<usize>> = HashMap::new();
        let mut loose = Vec::new();
        for (place, item) in relation.items.iter().enumerate() {
            match shared.iter().map(|name| item.keys.get(name)).collect() {
                Some(values) => by_values.entry(values).or_default().push(place),
                None => loose.push(place),
            }
        }
        Self { relation, shared, by_values, loose }
    }

    /// The items that agree with `keys`, in order.
    pub(in crate::pipeline) fn find(&self, keys: &Keys) -> Vec<usize> {
        let values: Option<Vec<&str>> = self.shared.iter().map(|name| keys.get(name)).collect();
        let mut found: Vec<usize> = match values {
            Some(values) => self.by_values.get(&values).into_iter().flatten().chain(&self.loose).copied().collect(),
            None => (0..self.relation.items.len()).collect(),
        };
        found.retain(|&place| self.relation.items[place].keys.agree(keys));
        found.sort_unstable();
        found
    }
}
