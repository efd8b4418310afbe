//! Charts at places: a row of cells after the other, some of them empty or a key to the colours.

use std::path::Path;

use anyhow::anyhow;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::super::picture::{Backend, Draw, write_both};
use super::points::colour;
use super::{Chart, Scales};

/// What stands at a place.
#[derive(Debug, Clone)]
pub enum Cell {
    /// Nothing.
    Empty,
    /// A chart.
    Chart(Chart),
    /// What the charts' colours mean.
    Key {
        /// Lines of words above.
        words: Vec<String>,
        /// A name for each colour.
        colours: Vec<(usize, String)>,
    },
}

/// Draws rows of cells, each `size` pixels wide and high, to `png` and `svg`.
///
/// # Errors
/// A file that can't be written.
pub fn draw_grid(rows: &[Vec<Cell>], size: [u32; 2], png: &Path, svg: &Path) -> anyhow::Result<()> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let pixels = (columns as u32 * size[0], rows.len().max(1) as u32 * size[1]);
    write_both(&Grid { rows, columns }, pixels, png, svg)
}

struct Grid<'a> {
    rows: &'a [Vec<Cell>],
    columns: usize,
}

impl Draw for Grid<'_> {
    fn draw<B: Backend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()> {
        let areas = area.split_evenly((self.rows.len(), self.columns));
        for (row, areas) in self.rows.iter().zip(areas.chunks(self.columns)) {
            for (cell, own) in row.iter().zip(areas) {
                match cell {
                    Cell::Empty => {}
                    Cell::Chart(chart) => chart.draw(own, Scales::Linear)?,
                    Cell::Key { words, colours } => key(own, words, colours)?,
                }
            }
        }
        Ok(())
    }
}

const LINE_PX: i32 = 24;

fn key<B: Backend>(area: &DrawingArea<B, Shift>, words: &[String], colours: &[(usize, String)]) -> anyhow::Result<()> {
    let failed = |why: DrawingAreaErrorKind<B::ErrorType>| anyhow!("{why}");
    let style = ("sans-serif", 17).into_font().color(&BLACK);
    let mut y = 40;
    for line in words {
        area.draw_text(line, &style, (30, y)).map_err(failed)?;
        y += LINE_PX;
    }
    for (k, name) in colours {
        let ink = colour(*k).stroke_width(3);
        area.draw(&PathElement::new([(30, y + 8), (58, y + 8)], ink)).map_err(failed)?;
        area.draw_text(name, &style, (68, y)).map_err(failed)?;
        y += LINE_PX;
    }
    Ok(())
}
