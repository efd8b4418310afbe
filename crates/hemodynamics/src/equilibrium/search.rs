//! All equilibria of a network with open vessels, by branch and prune.
//!
//! A box of lumens that holds every equilibrium is narrowed by the equations one by one and by interval Newton steps,
//! thrown away where nothing is left of it, and cut in two where several equilibria may be in it. No box is thrown away
//! but by a proof, so none is missed. An equilibrium is reported with a box that has been proved to hold exactly one,
//! so none is spurious and none is counted twice. What is proved is proved of the products of parameters that the model
//! has rounded once (`k D / A` and the like).
//!
//! Near a fold two equilibria approach each other as the root of the load's distance; where they can't be told from
//! each other or from none within rounding (nearer than [`NARROWEST`]), the place is reported once, as not certified.

use super::cell::{Cell, Step};
use super::domain::first_box;
use super::interval::Interval;
use super::network::Network;
use super::root::{LEAST_LUMEN, MOST_EQUILIBRIA, Root};
use super::twins::{mirrored, order_twins, twins};

/// Boxes narrower than this (over the nominal diameters) are not cut any more.
const NARROWEST: f64 = 1e-10;
/// Boxes narrower than this may be tried for the equilibrium that they hold.
const SMALL: f64 = 1e-3;
/// Boxes looked at before the search gives up.
const MOST_BOXES: usize = 100_000;
/// Undecided boxes nearer than this to each other are one fold.
const NEAR: f64 = 1e-6;
/// How much wider than an equilibrium in numbers the boxes are in which it is proved, over the nominal diameters.
const MARGINS: [f64; 3] = [1e-13, 1e-11, 1e-9];
/// The search did not end within its bounds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GaveUp {
    /// After so many boxes.
    Boxes(usize),
    /// There are more equilibria than this.
    Equilibria(usize),
}

/// Everything with open vessels at which the network rests.
pub(super) fn search(network: &Network) -> Result<Vec<Root>, GaveUp> {
    let mut stack: Vec<Cell> = first_box(network).into_iter().collect();
    let mut certified: Vec<Proof> = Vec::new();
    let mut undecided: Vec<Cell> = Vec::new();
    let twins = twins(network);
    let mut boxes = 0;
    'boxes: while let Some(mut cell) = stack.pop() {
        loop {
            boxes += 1;
            if boxes > MOST_BOXES {
                return Err(GaveUp::Boxes(MOST_BOXES));
            }
            let before = cell.width();
            if !order_twins(&mut cell, &twins) || !cell.narrow(network) {
                continue 'boxes;
            }
            let (vein, units) = middle(&cell);
            match cell.step(network, vein, &units) {
                Step::Empty => continue 'boxes,
                Step::Singular => {}
                Step::Image(image) => {
                    if !cell.meets(&image) {
                        continue 'boxes;
                    }
                    let holds_one = image.within(&cell);
                    cell = meet(&cell, &image);
                    if (holds_one || cell.width() < SMALL)
                        && let Some(proof) = prove(network, &cell, &twins)
                    {
                        if !certified.iter().any(|known| known.is_that_of(&proof, network)) {
                            certified.push(proof);
                        }
                        continue 'boxes;
                    }
                }
            }
            if cell.width() > 0.7 * before {
                break;
            }
        }
        match cell.cut(network, NARROWEST) {
            Some([left, right]) => stack.extend([right, left]),
            None if holds_none(network, &cell) => {}
            None => undecided.push(cell),
        }
    }
    undecided.retain(|cell| !certified.iter().any(|known| known.is_alone_with(cell, network)));
    let mut roots: Vec<Root> = certified.into_iter().map(|known| known.root).collect();
    roots.extend(folds(undecided));
    let mut roots = mirrored(roots, &twins).ok_or(GaveUp::Equilibria(MOST_EQUILIBRIA))?;
    roots.retain(|root| root.units.iter().chain([&root.vein]).all(|&lumen| lumen >= LEAST_LUMEN));
    roots.sort_by(|a, b| {
        a.vein.total_cmp(&b.vein).then_with(|| a.units.partial_cmp(&b.units).expect("lumens are finite"))
    });
    Ok(roots)
}

/// Whether the equations in their finer form show that a small box is empty.
fn holds_none(network: &Network, cell: &Cell) -> bool {
    let (vein, units) = middle(cell);
    match cell.fine_step(network, vein, &units) {
        Step::Empty => true,
        Step::Singular => false,
        Step::Image(image) => !cell.meets(&image),
    }
}

/// The state in the middle of a box.
fn middle(cell: &Cell) -> (f64, Vec<f64>) {
    (cell.vein.middle(), cell.units.iter().map(|range| range.middle()).collect())
}

fn meet(a: &Cell, b: &Cell) -> Cell {
    let both = |a: Interval, b: Interval| a.meet(b).unwrap_or(a);
    let units = a.units.iter().zip(&b.units).map(|(a, b)| both(*a, *b)).collect();
    Cell { vein: both(a.vein, b.vein), units }
}

/// An equilibrium with its proof.
struct Proof {
    /// Holds this equilibrium and no other.
    around: Cell,
    /// Holds it too, as near as it is known.
    image: Cell,
    root: Root,
}

impl Proof {
    /// Whether both prove the same equilibrium: the one's lies where the other's is the only one, or both lie where
    /// there is at most one.
    fn is_that_of(&self, other: &Proof, network: &Network) -> bool {
        if other.image.within(&self.around) || self.image.within(&other.around) {
            return true;
        }
        self.is_alone_with(&other.image, network)
    }

    /// Whether no other equilibrium is in a box near to this one.
    fn is_alone_with(&self, cell: &Cell, network: &Network) -> bool {
        let both = self.image.hull(cell);
        let (vein, units) = middle(&both);
        self.image.near(cell, NEAR) && matches!(both.step(network, vein, &units), Step::Image(_))
    }
}

/// The equilibrium that the box may hold, in numbers, and the proof that it is the only one in and around the box.
fn prove(network: &Network, cell: &Cell, twins: &[Option<usize>]) -> Option<Proof> {
    let (vein, units) = middle(cell);
    let (vein, mut units) = network.polish(vein, units)?;
    let image = MARGINS.iter().find_map(|&margin| {
        let near = Cell::about(vein, &units, margin);
        match near.fine_step(network, vein, &units) {
            Step::Image(image) if image.within(&near) => Some(image),
            _ => None,
        }
    })?;
    // There is one in the image; a box around both that the step is regular over holds no other.
    let around = cell.hull(&image);
    let Step::Image(_) = around.step(network, vein, &units) else { return None };
    for (i, twin) in twins.iter().enumerate() {
        // Were their lumens different, the mirrored equilibrium would be in the box as well.
        if let Some(k) = *twin
            && image.units[i].within(around.units[k])
            && image.units[k].within(around.units[i])
        {
            units[i] = units[k];
        }
    }
    Some(Proof { around, image, root: Root { vein, units, certified: true } })
}

/// Undecided boxes that lie together, each heap as one equilibrium.
fn folds(undecided: Vec<Cell>) -> Vec<Root> {
    let mut heaps: Vec<Cell> = Vec::new();
    for cell in undecided {
        let mut heap = cell;
        while let Some(at) = heaps.iter().position(|other| heap.near(other, NEAR)) {
            heap = heap.hull(&heaps.swap_remove(at));
        }
        heaps.push(heap);
    }
    let root = |heap: &Cell| {
        let (vein, units) = middle(heap);
        Root { vein, units, certified: false }
    };
    heaps.iter().map(root).collect()
}
