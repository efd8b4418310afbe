//! Which marker follows which along the finger, as the marker file's segments and joints tell.

use crate::posture::layout::Layout;

/// A marker in the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Link {
    /// The marker.
    pub(crate) marker: usize,
    /// The place in the chain of the marker before it on the way from proximal to distal.
    pub(crate) before: Option<usize>,
    /// Both are on one segment (if not, a joint lies between them).
    pub(crate) rigid: bool,
}

/// Markers such that each comes after the one before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Chain {
    pub(crate) links: Vec<Link>,
}

impl Chain {
    /// The chain of a layout: the needed markers, and those that have a colour in common with another one, for they help
    /// to tell which is which.
    ///
    /// A segment follows the one that a joint hangs it on. A segment in no joint is taken to follow, and to be followed
    /// by, its neighbours in the file.
    pub(crate) fn new(layout: &Layout) -> Self {
        let needed = layout.needed();
        let shared = |marker: usize| {
            let colour = layout.markers[marker].colour;
            layout.markers.iter().filter(|other| other.colour == colour).count() > 1
        };
        let wanted: Vec<bool> = (0..layout.markers.len()).map(|marker| needed[marker] || shared(marker)).collect();
        let count = layout.segments.len();
        let mut parent: Vec<Option<usize>> = vec![None; count];
        let mut jointed = vec![false; count];
        for joint in &layout.joints {
            let [proximal, distal] = joint.segments;
            (jointed[proximal], jointed[distal]) = (true, true);
            parent[distal] = parent[distal].or(Some(proximal));
        }
        for segment in 1..count {
            if parent[segment].is_none() && (!jointed[segment] || !jointed[segment - 1]) {
                parent[segment] = Some(segment - 1);
            }
        }
        let mut links: Vec<Link> = Vec::new();
        let mut done = vec![false; count];
        while let Some(segment) = next_segment(&parent, &done) {
            done[segment] = true;
            let [first, second] = layout.segments[segment].markers;
            let place = |links: &[Link], marker: usize| links.iter().position(|link| link.marker == marker);
            // The last marker before this segment that is in the chain, further and further towards the hand.
            let mut hung = None;
            let (mut at, mut steps) = (parent[segment], 0);
            while let (Some(before), None) = (at, hung) {
                let [near, far] = layout.segments[before].markers;
                hung = place(&links, far).or_else(|| place(&links, near));
                (at, steps) = (parent[before], steps + 1);
                if steps > count {
                    break;
                }
            }
            if wanted[first] && place(&links, first).is_none() {
                links.push(Link { marker: first, before: hung, rigid: false });
            }
            if wanted[second] && place(&links, second).is_none() {
                let before = place(&links, first);
                links.push(Link { marker: second, before: before.or(hung), rigid: before.is_some() });
            }
        }
        for marker in (0..layout.markers.len()).filter(|&marker| wanted[marker]) {
            if links.iter().all(|link| link.marker != marker) {
                links.push(Link { marker, before: None, rigid: false });
            }
        }
        Self { links }
    }
}

/// The next segment whose parent is done; in a ring of joints the first one left.
fn next_segment(parent: &[Option<usize>], done: &[bool]) -> Option<usize> {
    let left = || (0..done.len()).filter(|&segment| !done[segment]);
    left().find(|&segment| parent[segment].is_none_or(|parent| done[parent])).or_else(|| left().next())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn chain(text: &str) -> Vec<(String, Option<String>, bool)> {
        let layout = Layout::parse(text, Path::new("m.toml")).unwrap();
        let chain = Chain::new(&layout);
        let name = |place: usize| layout.markers[chain.links[place].marker].name.clone();
        (0..chain.links.len()).map(|k| (name(k), chain.links[k].before.map(name), chain.links[k].rigid)).collect()
    }

    fn link(name: &str, before: &str, rigid: bool) -> (String, Option<String>, bool) {
        (name.into(), (!before.is_empty()).then(|| before.into()), rigid)
    }

    #[test]
    fn joints_order_segments_and_shared_markers_are_one() {
        let text = "[markers]\na = '#ff0000'\nb = '#00ff00'\nc = '#0000ff'\nd = '#ffff00'\n\
            [segments]\nmiddle = ['b', 'c']\nproximal = ['a', 'b']\ndistal = ['c', 'd']\n\
            [joints]\nJ3 = ['middle', 'distal']\nJ2 = ['proximal', 'middle']\n";
        let expected = vec![link("a", "", false), link("b", "a", true), link("c", "b", true), link("d", "c", true)];
        assert_eq!(chain(text), expected);
    }

    #[test]
    fn markers_of_a_common_colour_help_though_no_joint_asks() {
        let text = |colour: &str| {
            format!(
                "[markers]\na = '{colour}'\nb = '#ff0000'\nc = '#ff0000'\nd = '#ff0000'\ne = '#ff0000'\nf = '{colour}'\n\
                [segments]\nhand = ['a', 'b']\nproximal = ['c', 'd']\nmiddle = ['e', 'f']\n\
                [joints]\nJ1 = ['hand', 'proximal']\n"
            )
        };
        assert_eq!(chain(&text("#ff0000")).len(), 6);
        let some = chain(&text("#0000ff"));
        assert_eq!(some.len(), 6, "two blue ones could be taken for one another");
        assert_eq!(some[4], link("e", "d", false));
    }
}
