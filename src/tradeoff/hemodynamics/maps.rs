//! Stability maps: what becomes of a finger under a load, over factors on its parameters.

use std::path::Path;

use lunula_hemodynamics::{Collapse, Fate, Inputs, LoadPath, MapPlan, MapRow, Parameters, Site, Symbol, stability_row};
use rayon::prelude::*;

use crate::figure::{Chart, Item, draw_panels};
use crate::files::Staging;
use crate::table::{Column, TableWriter, Value};
use crate::words::Words;

/// A map: a parameter over a load.
#[derive(Debug, Clone)]
pub struct Map {
    /// The parameters that are varied together.
    pub varied: &'static str,
    /// What the load presses on.
    pub pressed: &'static str,
    /// The loads, Pa.
    pub loads_pa: Vec<f64>,
    /// A row a factor.
    pub rows: Vec<MapRow>,
}

/// Factors from a tenth to ten, evenly in their logarithm.
const FACTORS: u32 = 80;
/// Loads from 0 on, Pa.
const LOADS: u32 = 120;
const LOAD_PA: f64 = 100.0;

/// The maps of stiffness, venules and the vein's length, each under proximal, distal and both loads.
///
/// # Errors
/// Equilibria that can't be found.
pub fn stability() -> anyhow::Result<Vec<Map>> {
    let parameters = Parameters::thesis();
    let capillaries = |symbol: fn(Site) -> Symbol| vec![symbol(Site::Capillary(0)), symbol(Site::Capillary(1))];
    let varied = [
        ("k_C", capillaries(Symbol::Stiffness)),
        ("k_V", vec![Symbol::Stiffness(Site::Vein)]),
        ("R_Vi", vec![Symbol::Venule(0), Symbol::Venule(1)]),
    ];
    let loads_pa: Vec<f64> = (0..=LOADS).map(|k| LOAD_PA * f64::from(k)).collect();
    let factors: Vec<f64> = (0..=FACTORS).map(|k| 10_f64.powf(2.0 * f64::from(k) / f64::from(FACTORS) - 1.0)).collect();
    let others = Inputs::unloaded(&parameters);
    let mut maps = Vec::new();
    for (name, symbols) in varied {
        for &(path, pressed, _) in LoadPath::WORDS {
            let plan = MapPlan {
                parameters: parameters.clone(),
                symbols: symbols.clone(),
                collapse: Collapse::Error,
                others,
                path,
                loads_pa: loads_pa.clone(),
            };
            let rows = factors.par_iter().map(|&factor| stability_row(&plan, factor)).collect::<Result<_, _>>()?;
            maps.push(Map { varied: name, pressed, loads_pa: loads_pa.clone(), rows });
        }
    }
    Ok(maps)
}

/// Words of a table, names of a legend and colours.
const FATES: [(Fate, &str, &str, usize); 4] = [
    (Fate::Converged, "converged", "one stable state", 2),
    (Fate::Bistable, "bistable", "several stable states", 4),
    (Fate::Restless, "restless", "open, none stable", 3),
    (Fate::Collapsed, "collapsed", "a vessel closes", 1),
];

/// Writes `stability.csv`, `stability.png` and `stability.svg`.
pub(in crate::tradeoff) fn write(maps: &[Map], staging: &Staging) -> anyhow::Result<()> {
    let mut columns = vec![Column::text("varied"), Column::text("load"), Column::number("factor")];
    columns.extend([Column::number("load_Pa"), Column::text("fate"), Column::number("tau_s")]);
    let mut table = TableWriter::create(&staging.place("stability.csv")?, Path::new("stability.csv"), columns, &[])?;
    for map in maps {
        for row in &map.rows {
            for (k, fate) in row.fates.iter().enumerate() {
                let word = FATES.iter().find(|known| known.0 == *fate).map_or("", |known| known.1);
                let (factor, load) = (Value::Number(row.factor), Value::Number(map.loads_pa[k]));
                let [varied, pressed, word] = [map.varied, map.pressed, word].map(Value::Text);
                table.write(&[varied, pressed, factor, load, word, Value::from(row.slowest_s[k])])?;
            }
        }
    }
    table.finish()?;
    let charts: Vec<Chart> = maps.iter().map(chart).collect();
    draw_panels(&charts, 3, 520, &staging.place("stability.png")?, &staging.place("stability.svg")?)
}

fn chart(map: &Map) -> Chart {
    let logs: Vec<f64> = map.rows.iter().map(|row| row.factor.log10()).collect();
    let half = 0.5 * (logs[1] - logs[0]);
    let step = 1e-4 * LOAD_PA;
    let mut items = Vec::new();
    for (fate, _, name, colour) in FATES {
        let mut runs = Vec::new();
        for (row, log) in map.rows.iter().zip(&logs) {
            let mut k = 0;
            for same in row.fates.chunk_by(|a, b| a == b) {
                if same[0] == fate {
                    let at = |k: usize| 1e-4 * map.loads_pa[k];
                    let (from, to) = (at(k) - 0.5 * step, at(k + same.len() - 1) + 0.5 * step);
                    runs.push([from, to].map(|x| [x, log - half, log + half]).to_vec());
                }
                k += same.len();
            }
        }
        if !runs.is_empty() {
            items.push(Item::Band { runs, colour });
            // A band has no name of its own.
            items.push(Item::Line { name: Some(name.to_owned()), runs: Vec::new(), colour, width: 4 });
        }
    }
    Chart::new(
        format!("{}, {} load{}", map.varied, map.pressed, if map.pressed == "both" { "s" } else { "" }),
        "load, N/cm2",
        format!("log10 of the factor on {}", map.varied),
        items,
        420,
    )
}
