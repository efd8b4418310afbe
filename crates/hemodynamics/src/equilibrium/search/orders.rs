//! Units that are the same: exchanging them takes an equilibrium to an equilibrium.

use crate::equilibrium::root::{MOST_EQUILIBRIA, Root};

/// The equilibria with all orders of the lumens of units that are the same; nothing where they are too many.
pub(super) fn in_all_orders<'a>(mut roots: Vec<Root>, classes: impl Iterator<Item = &'a [usize]>) -> Option<Vec<Root>> {
    for class in classes {
        let mut orders = Vec::new();
        for mut root in roots {
            let mut lumens: Vec<f64> = class.iter().map(|&i| root.units[i]).collect();
            lumens.sort_by(f64::total_cmp);
            loop {
                class.iter().zip(&lumens).for_each(|(&i, &lumen)| root.units[i] = lumen);
                orders.push(root.clone());
                if orders.len() > MOST_EQUILIBRIA {
                    return None;
                }
                if !next_order(&mut lumens) {
                    break;
                }
            }
        }
        roots = orders;
    }
    Some(roots)
}

/// The next order, the first being the growing one; false after the last.
fn next_order(values: &mut [f64]) -> bool {
    let Some(k) = (1..values.len()).rev().find(|&k| values[k - 1] < values[k]) else { return false };
    let other = (k..values.len()).rev().find(|&m| values[m] > values[k - 1]).expect("the one found above");
    values.swap(k - 1, other);
    values[k..].reverse();
    true
}
