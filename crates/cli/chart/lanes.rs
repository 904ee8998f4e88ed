//! Sequences of several runs, a lane each, with links between the same places.

use crate::figure::canvas::Area;
use crate::figure::text::{BODY, fit, line_height};

use super::drawing::{Drawing, Size, Tint, long};
use super::{GAP, MARGIN};

/// Space between two lanes, pixels: room for the links.
const BETWEEN: i32 = 64;
/// Space inside a stop's box, pixels.
const PAD: i32 = 6;
/// Half the width of a link, pixels.
const LINK: f32 = 1.25;
/// The longest name of a lane, characters.
const LONGEST: usize = 32;
/// Width of a box's coloured edge, pixels.
const EDGE: i32 = 3;

/// A stop of a lane.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Stop {
    /// What it is called.
    pub(crate) name: String,
    /// A second line under it.
    pub(crate) number: String,
    /// Whether a neighbouring lane has it too.
    pub(crate) shared: bool,
}

/// A sequence.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Lane {
    /// Its name.
    pub(crate) name: String,
    /// Its stops, in order.
    pub(crate) stops: Vec<Stop>,
}

/// The same place in a lane and in the one below it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Link {
    /// The upper lane.
    pub(crate) lane: usize,
    /// Its stop there.
    pub(crate) from: usize,
    /// Its stop in the lane below.
    pub(crate) to: usize,
    /// Whether its turn among the others is another.
    pub(crate) moved: bool,
}

/// Sequences under each other: a box a stop, a solid line between neighbouring lanes where a place keeps its turn among the
/// others, a dashed one where it is moved, and a grey box where the neighbours do not have it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lanes<'a> {
    /// Title.
    pub(crate) title: &'a str,
    /// Remarks under the title, a line each.
    pub(crate) remarks: &'a [String],
    /// The lanes, from the top.
    pub(crate) rows: &'a [Lane],
    /// The links between neighbouring lanes.
    pub(crate) links: &'a [Link],
}

impl Lanes<'_> {
    /// Lays the chart out.
    pub(crate) fn drawing(&self) -> Drawing {
        let stops = || self.rows.iter().flat_map(|lane| &lane.stops);
        let widest = |texts: &mut dyn Iterator<Item = &str>| texts.map(|t| long(BODY, t)).max();
        let inside =
            widest(&mut stops().flat_map(|s| [s.name.as_str(), s.number.as_str()])).unwrap_or(0);
        let (wide, high) = (inside + 2 * PAD, 2 * line_height(BODY) + 2 * PAD);
        let names: Vec<String> = self.rows.iter().map(|lane| fit(&lane.name, LONGEST)).collect();
        let left = MARGIN + widest(&mut names.iter().map(String::as_str)).unwrap_or(0) + 2 * GAP;
        let longest = self.rows.iter().map(|lane| lane.stops.len()).max().unwrap_or(0) as i32;
        let least = MARGIN + long(BODY, self.title) + MARGIN;
        let page = (left + longest * (wide + GAP) + MARGIN).max(least).max(520);
        let (mut drawing, top) = Drawing::begin(page, self.title, self.remarks);
        let place = |lane: usize, stop: usize| Area {
            left: left + stop as i32 * (wide + GAP),
            top: top + lane as i32 * (high + BETWEEN),
            width: wide,
            height: high,
        };
        for link in self.links {
            let (upper, lower) = (place(link.lane, link.from), place(link.lane + 1, link.to));
            let middle = |area: Area| (area.left + area.width / 2) as f32;
            let from = (middle(upper), upper.bottom() as f32);
            let to = (middle(lower), lower.top as f32);
            if link.moved {
                drawing.dashed(from, to, LINK, Tint::Alert);
            } else {
                drawing.line(from, to, LINK, Tint::Dark);
            }
        }
        for (lane, of) in self.rows.iter().enumerate() {
            let row = place(lane, 0);
            drawing.text_before(&names[lane], left - GAP, row.top + high / 2);
            for (turn, stop) in of.stops.iter().enumerate() {
                draw_stop(&mut drawing, place(lane, turn), lane, stop);
            }
            if of.stops.is_empty() {
                drawing.text_after("no goal reached", left, row.top + high / 2);
            }
        }
        let lanes = self.rows.len().max(1) as i32;
        drawing.height = top + lanes * high + (lanes - 1) * BETWEEN + MARGIN;
        drawing
    }
}

fn draw_stop(drawing: &mut Drawing, area: Area, lane: usize, stop: &Stop) {
    drawing.fill(area, if stop.shared { Tint::White } else { Tint::Grid });
    drawing.frame(area);
    drawing.fill(Area { height: EDGE, ..area }, Tint::Run(lane));
    let centre = |text: &str| area.left + (area.width - long(BODY, text)) / 2;
    for (text, line) in [(&stop.name, 0), (&stop.number, 1)] {
        if !text.is_empty() {
            let top = area.top + PAD + line * line_height(BODY);
            drawing.text_at(Size::Body, text, centre(text), top);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::drawing::Mark;

    fn lane(name: &str, places: &[usize], shared: bool) -> Lane {
        let stop = |p: &usize| Stop { name: format!("P{p}"), number: format!("0.{p}00"), shared };
        Lane { name: name.to_owned(), stops: places.iter().map(stop).collect() }
    }

    #[test]
    fn everything_is_on_the_page_and_links_are_solid_where_places_keep_their_turn() {
        let lanes = [
            lane("dsmc", &[1, 2, 3], true),
            lane("pcr6", &[2, 1, 12, 9, 8, 7, 6], true),
            lane("a rule with a name of more than any rule has", &[], false),
        ];
        let links = [
            Link { lane: 0, from: 0, to: 1, moved: false },
            Link { lane: 0, from: 1, to: 0, moved: true },
        ];
        let drawing =
            Lanes { title: "Goals in order", remarks: &[], rows: &lanes, links: &links }.drawing();
        drawing.check();
        let lines: Vec<(usize, Tint)> = drawing
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Lines { pieces, tint, .. } => Some((pieces.len(), *tint)),
                _ => None,
            })
            .collect();
        assert_eq!(lines[0], (1, Tint::Dark));
        assert!(lines[1].0 > 1 && lines[1].1 == Tint::Alert, "{lines:?}");
        assert!(drawing.texts().contains(&"P12") && drawing.texts().contains(&"no goal reached"));
    }
}
