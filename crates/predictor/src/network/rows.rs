//! Rows as training reads them: centred and scaled, in blocks, each column of a block side by side.

use ndarray::Array2;

use super::scaling::Scaling;

/// Rows in a block. Sums are formed block by block in this order, whatever the machine.
pub(super) const BLOCK: usize = 64;

const ROOM: usize = 3;

/// A value of each row of a block.
pub(super) type Column = [f64; BLOCK];

/// Blocks of rows; the last is filled with rows that count nothing.
#[derive(Debug, Clone)]
pub(super) struct Rows {
    /// How many count.
    pub(super) rows: usize,
    pub(super) inputs: usize,
    pub(super) targets: usize,
    /// For each block: ones where a row counts (the bias' input), inputs, targets.
    columns: Vec<Column>,
    /// Ones and inputs once more, row by row, each row with room for reading three beyond its end.
    by_row: Vec<f64>,
}

impl Rows {
    /// The rows of `x` and `y`, only the columns and targets given with their scaling.
    pub(super) fn new(
        x: &Array2<f64>,
        y: &Array2<f64>,
        inputs: &[(usize, Scaling)],
        targets: &[(usize, Scaling)],
    ) -> Self {
        let width = 1 + inputs.len() + targets.len();
        let mut columns = vec![[0.0; BLOCK]; x.nrows().div_ceil(BLOCK) * width];
        let stride = 1 + inputs.len() + ROOM;
        let mut by_row = vec![0.0; columns.len() / width * BLOCK * stride];
        for row in 0..x.nrows() {
            let block = &mut columns[row / BLOCK * width..][..width];
            let values = std::iter::once(1.0)
                .chain(inputs.iter().map(|(k, scaling)| scaling.apply(x[[row, *k]])))
                .chain(targets.iter().map(|(k, scaling)| scaling.apply(y[[row, *k]])));
            for (column, value) in block.iter_mut().zip(values) {
                column[row % BLOCK] = value;
            }
            let block = &columns[row / BLOCK * width..][..1 + inputs.len()];
            for (value, column) in by_row[row * stride..].iter_mut().zip(block) {
                *value = column[row % BLOCK];
            }
        }
        Self { rows: x.nrows(), inputs: inputs.len(), targets: targets.len(), columns, by_row }
    }

    /// Every block: ones and inputs, then targets.
    pub(super) fn blocks(&self) -> impl Iterator<Item = (&[Column], &[Column])> {
        self.columns.chunks_exact(1 + self.inputs + self.targets).map(|block| block.split_at(1 + self.inputs))
    }

    /// Every block's ones and inputs, row by row.
    pub(super) fn blocks_by_row(&self) -> impl Iterator<Item = &[f64]> {
        self.by_row.chunks_exact(self.stride() * BLOCK)
    }

    /// From a row's first to the next one's in [`blocks_by_row`](Self::blocks_by_row).
    pub(super) fn stride(&self) -> usize {
        1 + self.inputs + ROOM
    }

    /// Least and greatest of each input.
    pub(super) fn ranges(&self) -> Vec<(f64, f64)> {
        let mut ranges = vec![(f64::INFINITY, f64::NEG_INFINITY); self.inputs];
        let mut left = self.rows;
        for (inputs, _) in self.blocks() {
            let here = left.min(BLOCK);
            left -= here;
            for ((low, high), column) in ranges.iter_mut().zip(&inputs[1..]) {
                for value in &column[..here] {
                    (*low, *high) = (low.min(*value), high.max(*value));
                }
            }
        }
        ranges
    }
}
