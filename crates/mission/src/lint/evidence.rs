//! What the tables can say together: dull ground, the most interesting ground, and what a prize makes of them.

use std::collections::BTreeMap;

use wisdom_autonomy::{ELEVATION, Source};
use wisdom_belief::{InterestMass, Rule, Uncertainty};
use wisdom_fusion::{Expert, Statistic, credit_of, interest_map, judge};
use wisdom_goals::{Directive, Kind, PrizeScale, prize_map};
use wisdom_grid::{GridSpec, Raster};
use wisdom_terrain::Layer;

use super::{Lint, Linter, short};
use crate::world::Prior;

/// The most fusions that one question may take: a second or two.
const MOST_FUSIONS: usize = 1_000_000;

/// The largest first map whose background is looked up, cells.
const MOST_CELLS: usize = 1 << 22;

/// Interest is kept as f32, and what a table can just reach must not be called out of reach.
const ROUNDING: f64 = 1e-6;

/// The uncertainties at which rows are tried: finely where that is cheap, else certain or unseen.
const FINELY: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
const COARSELY: [f64; 2] = [0.0, 1.0];

/// What can be said of all that the tables can say together.
struct Reach {
    /// The largest interest.
    most: f64,
    /// For each directive, the largest share of credit its experts have where the interest suffices it.
    share: Vec<f64>,
    /// How it was found, in words.
    how: String,
}

impl Linter<'_> {
    /// Thresholds against dull ground and against the most interesting ground.
    pub(super) fn thresholds(&mut self) {
        let spec = &self.mission.spec;
        let fusion = spec.fusion;
        let background = self.dull();
        for (i, directive) in spec.directives.iter().enumerate() {
            let asked = directive.min_interest;
            if directive.kind == Kind::Inspect && asked > 0.0 && asked <= background {
                let message = format!(
                    "{} of `{}` is not above {}, the {} of dull ground: every expert's dullest row, read as well as \
                     this mission reads, fused by {}; it turns nothing away. Set it above {}, or drop it",
                    short(asked),
                    directive.name,
                    short(background),
                    fusion.statistic,
                    fusion.rule,
                    short(background),
                );
                let path = ["directive", &i.to_string(), "min-interest"];
                self.warn(Lint::ThresholdBelowBackground, &path, message);
            }
        }
        let Some(reach) = self.reach() else {
            let message = format!(
                "directive-never-fires and constant-prize: the tables' rows combine in more ways than {MOST_FUSIONS} \
                 fusions by {} can try",
                fusion.rule
            );
            self.warn(Lint::NotChecked, &["experts"], message);
            return;
        };
        for (i, directive) in spec.directives.iter().enumerate() {
            self.out_of_reach(i, directive, &reach);
            self.shadowed(i, directive);
        }
    }

    fn out_of_reach(&mut self, i: usize, directive: &Directive, reach: &Reach) {
        let (name, how) = (&directive.name, &reach.how);
        let index = i.to_string();
        let asked = directive.min_interest;
        if asked > reach.most + ROUNDING {
            let message = format!(
                "{} of `{name}` is above {}, the most that the tables can say together ({how}); no site can have it. \
                 Lower it, or look into the tables",
                short(asked),
                short(reach.most),
            );
            self.warn(Lint::DirectiveNeverFires, &["directive", &index, "min-interest"], message);
            return;
        }
        let share = reach.share[i];
        if !directive.experts.is_empty() && directive.min_credit > share + ROUNDING {
            let message = format!(
                "{} of `{name}` is above {}, the largest share its experts have where the interest reaches {} \
                 ({how}); no site can have both. Lower one of the two",
                short(directive.min_credit),
                short(share),
                short(asked),
            );
            self.warn(Lint::DirectiveNeverFires, &["directive", &index, "min-credit"], message);
        }
    }

    /// A site goes to the heaviest directive that accepts it, the earlier of two as heavy.
    fn shadowed(&mut self, i: usize, directive: &Directive) {
        let all = &self.mission.spec.directives;
        if all.iter().any(|other| other.substitute == Some(i)) {
            return;
        }
        let additive = self.mission.spec.fusion.rule == Rule::Dsmc;
        let before = |(o, other): &(usize, &Directive)| {
            *o != i
                && (other.weight > directive.weight || (other.weight == directive.weight && *o < i))
                && accepts_all(other, directive, additive)
        };
        let Some((_, other)) = all.iter().enumerate().find(before) else { return };
        let message = format!(
            "`{}` (weight {}) never gets a site: `{}` (weight {}) accepts all that it accepts and comes first. Raise \
             its weight above {}, or ask more of the other",
            directive.name, directive.weight, other.name, other.weight, other.weight
        );
        self.warn(Lint::DirectiveNeverFires, &["directive", &i.to_string(), "weight"], message);
    }

    /// A prize that cannot tell one place from another.
    pub(super) fn prize(&mut self) {
        let spec = &self.mission.spec;
        let (fusion, scale) = (spec.fusion, spec.prize);
        // Where the rows cannot all be tried, that was said with the thresholds.
        let (Some((least, most)), Some(reach)) = (self.seen_range(), self.reach()) else { return };
        if most - least < ROUNDING {
            let message = format!(
                "the {} of any ground that is seen for certain is {}: rule {} makes the same of all rows of the \
                 tables, so that no place is better than another. Choose another rule, paradox policy or statistic, \
                 or look into the tables",
                fusion.statistic,
                short(most),
                fusion.rule
            );
            self.warn(Lint::ConstantPrize, &["rule"], message);
            return;
        }
        let (background, whose) = match scale {
            PrizeScale::Contrast => match self.first_background() {
                Some(median) => (median, "the median of the first map"),
                None => (self.dull(), "that of dull ground"),
            },
            _ => (0.0, "nothing"),
        };
        let largest =
            if background < 1.0 { (reach.most - background) / (1.0 - background) } else { 0.0 };
        let asked = spec.manager.extraction.min_prominence;
        if largest + ROUNDING < asked {
            let message = format!(
                "the largest {scale} is {}: {} at most, above {} ({whose}); goals.min-prominence asks for {}, so that \
                 nothing stands out. Lower it, or choose another prize or rule",
                short(largest.max(0.0)),
                short(reach.most),
                short(background),
                short(asked)
            );
            self.warn(Lint::ConstantPrize, &["prize"], message);
        }
    }

    /// The interest of a cell that every expert reads as its dullest row, as well as the mission reads.
    fn dull(&self) -> f64 {
        let spec = &self.mission.spec;
        let dullest = |expert: &Expert| {
            let duller = |a: &&InterestMass, b: &&InterestMass| {
                let by = a.not_interesting().total_cmp(&b.not_interesting());
                by.then(b.interesting().total_cmp(&a.interesting()))
            };
            let row = expert.table.masses().iter().max_by(duller).expect("`outside` is a row");
            row.discounted(self.least_u(&expert.layer))
        };
        let sources: Vec<InterestMass> = spec.experts.iter().map(dullest).collect();
        spec.fusion.interest(&sources)
    }

    /// The least uncertainty with which a layer is read: by an instrument from nearby, or beforehand.
    fn least_u(&self, layer: &str) -> Uncertainty {
        let mission = self.mission;
        let layer = if mission.spec.measures(layer) { layer } else { ELEVATION };
        let reads = |names: &[String]| names.iter().any(|name| name == layer);
        let instruments = mission.world.instruments().iter().filter(|i| reads(&i.layers));
        let before = match mission.world.known_before() {
            Prior::Complete => 0.0,
            Prior::Averaged { u, .. } => *u,
            Prior::FirstLook { uncertainty, .. } if uncertainty.contains_key(layer) => 0.0,
            Prior::None | Prior::FirstLook { .. } => 1.0,
        };
        let least = instruments.map(|i| i.u0).fold(before, f64::min);
        Uncertainty::new(least).expect("uncertainties of a mission lie in [0, 1]")
    }

    /// What the rows of all tables can say together, whatever the uncertainty; none if that takes too long.
    fn reach(&self) -> Option<Reach> {
        let spec = &self.mission.spec;
        let (rule, statistic) = (spec.fusion.rule, spec.fusion.statistic);
        if rule == Rule::Dsmc && statistic == Statistic::Belief {
            return Some(self.reach_of_dsmc());
        }
        // Credit under other rules asks every coalition of the experts.
        let each = if rule == Rule::Dsmc { 1 } else { (1 << spec.experts.len()) + 1 };
        let tried = [&FINELY[..], &COARSELY[..]].map(|levels| (levels, self.choices(levels)));
        let (levels, choices) = tried
            .into_iter()
            .find(|(_, choices)| count(choices).saturating_mul(each) <= MOST_FUSIONS)?;
        let levels: Vec<String> = levels.iter().map(ToString::to_string).collect();
        let how =
            format!("{} combinations of rows, at u of {} each", count(&choices), levels.join(", "));
        let mut reach = Reach { most: 0.0, share: vec![0.0; spec.directives.len()], how };
        for_each(&choices, |sources| {
            let interest = spec.fusion.interest(sources);
            reach.most = reach.most.max(interest);
            let mut credit = None;
            for (directive, best) in spec.directives.iter().zip(&mut reach.share) {
                if *best >= directive.min_credit || interest < directive.min_interest {
                    continue;
                }
                let credit = credit.get_or_insert_with(|| credit_of(sources, &spec.fusion));
                *best = best.max(directive.experts.iter().map(|&e| credit[e]).sum());
            }
        });
        Some(reach)
    }

    /// Under `dsmc` each expert has a weight of evidence, −ln(1 − Bel), that u takes down to 0: interest grows with the
    /// sum, and credit is a part of it, so that the best is known without trying.
    fn reach_of_dsmc(&self) -> Reach {
        let spec = &self.mission.spec;
        let strongest: Vec<InterestMass> = spec
            .experts
            .iter()
            .map(|expert| {
                let stronger =
                    |a: &&InterestMass, b: &&InterestMass| a.belief().total_cmp(&b.belief());
                *expert.table.masses().iter().max_by(stronger).expect("`outside` is a row")
            })
            .collect();
        let weight = |belief: f64| -libm::log1p(-belief.min(1.0 - ROUNDING));
        let share = |directive: &Directive| {
            let weigh = |(e, mass): (usize, &InterestMass)| {
                (directive.experts.contains(&e), weight(mass.belief()))
            };
            let weights = || strongest.iter().enumerate().map(weigh);
            let own: f64 = weights().filter(|(own, _)| *own).map(|(_, weight)| weight).sum();
            let others: f64 = weights().filter(|(own, _)| !own).map(|(_, weight)| weight).sum();
            // The others say no more than the interest still lacks.
            let lacking = (weight(directive.min_interest) - own).clamp(0.0, others);
            if own > 0.0 { own / (own + lacking) } else { 0.0 }
        };
        Reach {
            most: spec.fusion.interest(&strongest),
            share: spec.directives.iter().map(share).collect(),
            how: "the strongest row of each table, at any u".to_owned(),
        }
    }

    /// The least and the largest interest of ground that every expert sees for certain; none if that takes too long.
    fn seen_range(&self) -> Option<(f64, f64)> {
        let fusion = &self.mission.spec.fusion;
        let choices = self.choices(&[0.0]);
        let mut range = (f64::INFINITY, f64::NEG_INFINITY);
        let mut widen = |sources: &[InterestMass]| {
            let interest = fusion.interest(sources);
            range = (range.0.min(interest), range.1.max(interest));
        };
        if count(&choices) <= MOST_FUSIONS {
            for_each(&choices, widen);
            return Some(range);
        }
        // Two that differ are enough to tell.
        let first: Vec<InterestMass> = choices.iter().map(|rows| rows[0]).collect();
        for (expert, rows) in choices.iter().enumerate() {
            let mut sources = first.clone();
            for row in rows {
                sources[expert] = *row;
                widen(&sources);
            }
        }
        (range.1 - range.0 >= ROUNDING).then_some(range)
    }

    /// For each expert, all that it can say at some uncertainties; what it says twice counts once.
    fn choices(&self, levels: &[f64]) -> Vec<Vec<InterestMass>> {
        let said = |expert: &Expert| {
            let mut said: Vec<InterestMass> = Vec::new();
            for level in levels {
                let u = Uncertainty::new(*level).expect("a level lies in [0, 1]");
                for row in expert.table.masses() {
                    let mass = row.discounted(u);
                    if !said.contains(&mass) {
                        said.push(mass);
                    }
                }
            }
            said
        };
        self.mission.spec.experts.iter().map(said).collect()
    }

    /// The median interest of the first map, if anything is known of it and it is cheap to draw.
    fn first_background(&self) -> Option<f64> {
        let Ok(known) = self.first_layers() else { return None };
        let known = known?;
        let spec = &self.mission.spec;
        let interest = interest_map(&judge(&spec.experts, &known).ok()?, &spec.fusion);
        let seen = interest.ignorance.values().iter().any(|u| *u < 1.0);
        seen.then(|| prize_map(&interest.interest, &interest.ignorance, spec.prize).background)
    }

    /// The layers as they are known beforehand.
    fn first_layers(&self) -> Result<Option<BTreeMap<String, Layer>>, Box<dyn std::error::Error>> {
        let (spec, world) = (&self.mission.spec, &self.mission.world);
        let working = spec.working_map(world.execution().start);
        if working.rows * working.cols > MOST_CELLS || !world.is_at_hand() {
            return Ok(None);
        }
        let part: GridSpec = spec.grid.part(working)?;
        let mut layers = BTreeMap::new();
        for known in world.prior(&spec.layers, working)? {
            let values = Raster::from_vec(part, known.values)?;
            let uncertainty = Raster::from_vec(part, known.uncertainty)?;
            layers.insert(known.layer, Layer::new(values, uncertainty)?);
        }
        for layer in spec.layers.iter().filter(|l| matches!(l.source, Source::Measured(_))) {
            layers.entry(layer.name.clone()).or_insert_with(|| Layer::unknown(part));
        }
        for layer in &spec.layers {
            if let Source::Derived(derivation) = layer.source {
                let derived = derivation.of(&layers[ELEVATION], spec.vehicle.footprint_radius_m);
                layers.insert(layer.name.clone(), derived);
            }
        }
        Ok(Some(layers))
    }
}

/// Whether a directive accepts every site that another one accepts. Under rules that are not additive a share of
/// credit may be negative, so that more experts may have less of it.
fn accepts_all(one: &Directive, other: &Directive, additive: bool) -> bool {
    let anyone = |d: &Directive| d.experts.is_empty() || (additive && d.min_credit <= 0.0);
    let same = one.experts.len() == other.experts.len()
        && one.experts.iter().all(|e| other.experts.contains(e));
    let more = additive && other.experts.iter().all(|e| one.experts.contains(e));
    let credit = anyone(one)
        || (!other.experts.is_empty() && (same || more) && one.min_credit <= other.min_credit);
    let broader = one.kind == other.kind
        && one.min_signal <= other.min_signal
        && one.object.is_none()
        && one.window.is_none();
    broader && one.min_interest <= other.min_interest && credit
}

fn count(choices: &[Vec<InterestMass>]) -> usize {
    choices.iter().fold(1, |product, said| product.saturating_mul(said.len()))
}

/// Every combination of one choice each, the last turning fastest.
fn for_each(choices: &[Vec<InterestMass>], mut visit: impl FnMut(&[InterestMass])) {
    let mut at = vec![0; choices.len()];
    let mut sources: Vec<InterestMass> = choices.iter().map(|said| said[0]).collect();
    loop {
        visit(&sources);
        let Some(turn) = (0..at.len()).rev().find(|&k| at[k] + 1 < choices[k].len()) else {
            return;
        };
        at[turn] += 1;
        at[turn + 1..].fill(0);
        for k in turn..at.len() {
            sources[k] = choices[k][at[k]];
        }
    }
}
