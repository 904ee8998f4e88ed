//! What the pages of the rules, and the table to choose from, say is what the library computes.

use wisdom_belief::rule::{self, Settings};
use wisdom_belief::{BeliefError, Frame, MassFunction, Model, Rule};

/// Where the choice of a rule is explained.
const GUIDE: &str = include_str!("../../../docs/rules.md");

/// The sections of a page, in their order.
const SECTIONS: [&str; 6] =
    ["Formula", "Model", "Order", "Reference", "Zadeh's example", "The paper's point (67, 20)"];

/// The widest line that a terminal shows unbroken.
const COLUMNS: usize = 100;

/// Decimals of a result.
const DECIMALS: usize = 6;

/// A printed result is off by half a unit in its last place; the rest is for values that lie on the middle
/// between two, which rounding of binary fractions decides.
const HALF_A_UNIT: f64 = 0.500_001e-6;

/// Masses of sources are decimals, read here and multiplied there.
const SOURCE_TOLERANCE: f64 = 1e-12;

/// What one source says, by expressions.
type Words = &'static [(&'static str, f64)];

/// Two physicians who agree only on what both find unlikely (Zadeh 1979).
const ZADEH: [Words; 2] = [&[("A", 0.9), ("C", 0.1)], &[("B", 0.9), ("C", 0.1)]];

/// The paper's Table 6: gradient, texture, temperature.
const TABLE_6: [Words; 3] = [
    &[("I", 0.8), ("NI", 0.05), ("I & NI", 0.15)],
    &[("I", 0.323), ("Theta", 0.66), ("I & NI", 0.017)],
    &[("NI", 0.648), ("Theta", 0.19), ("I & NI", 0.162)],
];

/// The paper's Table 8: the same, the paradox moved to ignorance.
const TABLE_8: [Words; 3] = [
    &[("I", 0.8), ("NI", 0.05), ("Theta", 0.15)],
    &[("I", 0.323), ("Theta", 0.677)],
    &[("NI", 0.648), ("Theta", 0.352)],
];

/// An example that every page works out.
#[derive(Clone, Copy)]
enum Example {
    Zadeh,
    Paper,
}

impl Example {
    fn section(self) -> &'static str {
        match self {
            Self::Zadeh => SECTIONS[4],
            Self::Paper => SECTIONS[5],
        }
    }

    fn atoms(self) -> &'static [&'static str] {
        match self {
            Self::Zadeh => &["A", "B", "C"],
            Self::Paper => &["I", "NI"],
        }
    }

    fn frame(self, model: Model) -> Frame {
        Frame::new(self.atoms().iter().copied(), model).expect("a few atoms")
    }

    fn sources(self, frame: &Frame) -> Vec<MassFunction> {
        let words: &[Words] = match self {
            Self::Zadeh => &ZADEH,
            Self::Paper if frame.is_free() => &TABLE_6,
            Self::Paper => &TABLE_8,
        };
        let read = |words: &Words| MassFunction::parse(frame, words.iter().copied());
        words.iter().map(|words| read(words).expect("masses of the example")).collect()
    }
}

/// A table of a page: sources and what a rule makes of them.
struct Table<'a> {
    caption: &'a str,
    columns: Vec<&'a str>,
    rows: Vec<(&'a str, Vec<&'a str>)>,
}

fn cells(line: &str) -> Vec<&str> {
    line.trim().trim_matches('|').split('|').map(str::trim).collect()
}

/// The tables of a text, each under the paragraph that ends above it.
fn tables(text: &str) -> Vec<Table<'_>> {
    let (mut tables, mut caption, mut inside) = (Vec::<Table<'_>>::new(), "", false);
    for line in text.lines() {
        let is_row = line.starts_with('|');
        if !is_row && !line.is_empty() {
            caption = line;
        } else if is_row && !inside {
            let columns = cells(line).split_off(1);
            tables.push(Table { caption, columns, rows: Vec::new() });
        } else if is_row && !line.starts_with("|-") {
            let mut row = cells(line);
            let label = row.remove(0);
            tables.last_mut().expect("inside of a table").rows.push((label, row));
        }
        inside = is_row;
    }
    tables
}

/// The text of a section of a page.
fn section<'a>(page: &'a str, name: &str) -> Result<&'a str, String> {
    let found = page.split("\n## ").skip(1).find_map(|section| {
        let (heading, text) = section.split_once('\n')?;
        (heading == name).then_some(text.trim())
    });
    found.filter(|text| !text.is_empty()).ok_or_else(|| format!("no section {name:?}"))
}

/// An element as pages write it, as expressions do.
fn expression(text: &str) -> String {
    text.replace('∪', "|").replace('∩', "&").replace('Θ', "Theta").replace('∅', "empty")
}

/// What a table is about: the model that results are on, and that of the sources.
fn frames(example: Example, caption: &str) -> Result<(Frame, Frame), String> {
    let (free, shafer) = (example.frame(Model::Free), example.frame(Model::Shafer));
    if caption.starts_with("Free model") {
        return Ok((free.clone(), free));
    }
    if caption.starts_with("Shafer's model") {
        return Ok((shafer.clone(), shafer));
    }
    if caption.starts_with("From the free model to Shafer's") {
        return Ok((shafer, free));
    }
    Err(format!("a table without a model: {caption:?}"))
}

/// The sources a table must list: those of the example, or what the caption made of them.
fn expected_sources(
    example: Example,
    caption: &str,
    frame: &Frame,
) -> Result<Vec<MassFunction>, String> {
    let sources = example.sources(frame);
    let Some((_, moved)) = caption.trim_end_matches(':').split_once(", ") else {
        return Ok(sources);
    };
    let (share, to) = moved
        .split_once(" of each source moved to ")
        .ok_or_else(|| format!("{moved:?} is not understood"))?;
    let share = number(share)?;
    let to = frame.parse(&expression(to)).map_err(|error| error.to_string())?;
    let moved = |source: &MassFunction| {
        let kept = source.focal().iter().filter(|&&(element, _)| element != to);
        let kept = kept.map(|&(element, mass)| (element, mass * (1.0 - share)));
        let gains = source.mass(to) * (1.0 - share) + share;
        MassFunction::new(frame, kept.chain([(to, gains)])).map_err(|error| error.to_string())
    };
    sources.iter().map(moved).collect()
}

fn number(text: &str) -> Result<f64, String> {
    text.parse().map_err(|_| format!("{text:?} is not a number"))
}

/// What a column says of a mass function: Bel or `BetP` of an element, or its mass.
fn read_off(column: &str, mass: &MassFunction, frame: &Frame) -> Result<f64, String> {
    let element = |text: &str| frame.parse(&expression(text)).map_err(|error| error.to_string());
    let inside = |name: &str| column.strip_prefix(name)?.strip_prefix('(')?.strip_suffix(')');
    if let Some(text) = inside("Bel") {
        return Ok(mass.belief(element(text)?));
    }
    if let Some(text) = inside("BetP") {
        return Ok(mass.pignistic(element(text)?));
    }
    Ok(mass.mass(element(column)?))
}

fn is_measure(column: &str) -> bool {
    column.ends_with(')')
}

/// A source's row against the source.
fn check_source(
    table: &Table<'_>,
    row: &[&str],
    source: &MassFunction,
    frame: &Frame,
) -> Result<(), String> {
    let mut listed = 0.0;
    for (column, cell) in table.columns.iter().zip(row) {
        if is_measure(column) {
            continue;
        }
        let (printed, exact) = (number(cell)?, read_off(column, source, frame)?);
        if (printed - exact).abs() > SOURCE_TOLERANCE {
            return Err(format!("a source's m({column}) is {printed}; it should be {exact}"));
        }
        listed += printed;
    }
    if (listed - 1.0).abs() > SOURCE_TOLERANCE {
        return Err(format!("the masses of a source come to {listed}"));
    }
    Ok(())
}

/// A printed number against the exact one.
fn check_number(what: &str, printed: &str, exact: f64) -> Result<(), String> {
    let decimals = printed.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    if decimals != DECIMALS || (number(printed)? - exact).abs() > HALF_A_UNIT {
        return Err(format!("{what} is {printed}; it should be {exact:.DECIMALS$}"));
    }
    Ok(())
}

/// A result's row against the result; dashes stand for an error, whose words the section must quote.
fn check_result(
    table: &Table<'_>,
    (label, row): (&str, &[&str]),
    fused: Result<MassFunction, BeliefError>,
    frame: &Frame,
    section: &str,
) -> Result<(), String> {
    let fused = match fused {
        Ok(fused) => fused,
        Err(error) => {
            let quoted = section.replace('\n', " ").contains(&format!("The error: `{error}`"));
            let dashes = row.iter().all(|&cell| cell == "–");
            return if quoted && dashes { Ok(()) } else { Err(format!("{label}: {error}")) };
        }
    };
    let mut listed = Vec::new();
    for (column, cell) in table.columns.iter().zip(row) {
        check_number(&format!("{label}: {column}"), cell, read_off(column, &fused, frame)?)?;
        if !is_measure(column) {
            listed.push(frame.parse(&expression(column)).map_err(|error| error.to_string())?);
        }
    }
    match fused.focal().iter().find(|(element, _)| !listed.contains(element)) {
        Some(&(element, mass)) => {
            Err(format!("{label}: m({}) = {mass} is not listed", frame.print(element)))
        }
        None => Ok(()),
    }
}

/// What a row of results stands for: all sources at once, with a setting, or two at a time.
fn result_of(
    rule: Rule,
    label: &str,
    sources: &[MassFunction],
    (frame, given_on): (&Frame, &Frame),
) -> Result<Result<MassFunction, BeliefError>, String> {
    let mut settings = Settings::default();
    if frame != given_on {
        settings = settings.with_source_frame(given_on);
    }
    Ok(match label {
        "fused" => rule::combine_with(rule, sources, frame, &settings),
        "folded" => rule::fold(rule, sources, frame, &settings),
        "folded upwards" => {
            let upwards: Vec<_> = sources.iter().rev().cloned().collect();
            rule::fold(rule, &upwards, frame, &settings)
        }
        _ => {
            let k = label.strip_prefix("fused, k = ").filter(|_| rule == Rule::Inagaki);
            let k = number(k.ok_or_else(|| format!("row {label:?} is not understood"))?)?;
            rule::combine_with(rule, sources, frame, &settings.with_inagaki_k(k))
        }
    })
}

fn check_table(
    rule: Rule,
    example: Example,
    table: &Table<'_>,
    section: &str,
) -> Result<(), String> {
    let (frame, given_on) = frames(example, table.caption)?;
    let sources = expected_sources(example, table.caption, &given_on)?;
    if table.rows.len() <= sources.len() {
        return Err("a table without results".to_owned());
    }
    for (label, row) in &table.rows {
        if row.len() != table.columns.len() {
            return Err(format!("row {label:?} has {} cells", row.len()));
        }
    }
    let (said, results) = table.rows.split_at(sources.len());
    for ((_, row), source) in said.iter().zip(&sources) {
        check_source(table, row, source, &given_on)?;
    }
    for (label, row) in results {
        let fused = result_of(rule, label, &sources, (&frame, &given_on))?;
        check_result(table, (label, row), fused, &frame, section)?;
    }
    Ok(())
}

/// Decimal fractions of a text.
fn fractions(text: &str) -> impl Iterator<Item = &str> {
    let tokens = text.split(|c: char| !(c.is_ascii_digit() || c == '.'));
    tokens.map(|token| token.trim_matches('.')).filter(|token| token.contains('.'))
}

/// A number in the text around a table must be one that the table, which is checked, has too.
fn check_prose(text: &str) -> Result<(), String> {
    let (rows, prose): (Vec<_>, Vec<_>) = text.lines().partition(|line| line.starts_with('|'));
    let rows = rows.join("\n");
    let checked: Vec<_> = fractions(&rows).collect();
    match prose.iter().flat_map(|line| fractions(line)).find(|token| !checked.contains(token)) {
        Some(token) => Err(format!("{token} is in no table")),
        None => Ok(()),
    }
}

/// Everything an example's section says.
fn check_example(rule: Rule, example: Example, page: &str) -> Result<(), String> {
    let text = section(page, example.section())?;
    let tables = tables(text);
    let caption = match rule.model() {
        Model::Free => "Free model:",
        _ => "Shafer's model:",
    };
    if tables.first().is_none_or(|table| table.caption != caption) {
        return Err(format!("the first table should be headed {caption:?}"));
    }
    tables.iter().try_for_each(|table| check_table(rule, example, table, text))?;
    check_prose(text)
}

#[test]
fn every_rule_has_a_page_of_all_sections_that_fits_a_terminal() {
    for rule in Rule::ALL {
        let page = rule.page();
        let headings: Vec<&str> =
            page.lines().filter_map(|line| line.strip_prefix("## ")).collect();
        assert_eq!(headings, SECTIONS, "{rule}");
        for name in SECTIONS {
            section(page, name).unwrap_or_else(|fault| panic!("{rule}: {fault}"));
        }
        assert!(page.starts_with("# "), "{rule} has no title");
        assert!(page.contains(&format!("\nRule `{rule}`. ")), "{rule} is not named");
        assert_eq!(page.matches("\n# ").count(), 0, "{rule} has one title");
        let widest = page.lines().max_by_key(|line| line.chars().count()).expect("lines");
        assert!(widest.chars().count() <= COLUMNS, "{rule}: {widest}");
    }
}

#[test]
fn rules_named_on_pages_exist() {
    for text in Rule::ALL.map(Rule::page).into_iter().chain([GUIDE]) {
        let code = text.split('`').skip(1).step_by(2);
        let is_name =
            |code: &&str| code.chars().all(|c| c.is_ascii_lowercase() || "-0123456789".contains(c));
        for name in code.filter(is_name) {
            // Functions of the library, a row of a table and a policy look like rules.
            let known = ["combine", "fold", "fused", "keep-for-dsmh"].contains(&name);
            assert!(known || name.parse::<Rule>().is_ok(), "{name}");
        }
    }
}

#[test]
fn zadehs_example_is_what_the_library_computes() {
    for rule in Rule::ALL {
        check_example(rule, Example::Zadeh, rule.page())
            .unwrap_or_else(|fault| panic!("{rule}: {fault}"));
    }
}

#[test]
fn the_papers_point_is_what_the_library_computes() {
    for rule in Rule::ALL {
        check_example(rule, Example::Paper, rule.page())
            .unwrap_or_else(|fault| panic!("{rule}: {fault}"));
    }
}

/// A page with another digit somewhere in its tables fails, be it the last one of a number.
#[test]
fn a_wrong_digit_anywhere_in_a_table_is_found() {
    for rule in [Rule::Pcr6, Rule::Dsmc, Rule::Inagaki, Rule::Cautious] {
        let page = rule.page();
        let start = page.find("## Zadeh").expect("a section");
        let mut row = false;
        for (at, c) in page.char_indices().skip_while(|&(at, _)| at < start) {
            row = if c == '\n' { page[at + 1..].starts_with("| ") } else { row };
            let in_fraction = page[..at].ends_with(|c: char| c == '.' || c.is_ascii_digit());
            let Some(digit) = c.to_digit(10).filter(|_| row && in_fraction) else { continue };
            let wrong = format!("{}{}{}", &page[..at], (digit + 3) % 10, &page[at + 1..]);
            let found = check_example(rule, Example::Zadeh, &wrong)
                .and_then(|()| check_example(rule, Example::Paper, &wrong));
            assert!(found.is_err(), "{rule}: nobody saw the digit at byte {at}");
        }
    }
}

#[test]
fn the_order_section_says_what_the_algebra_does() {
    for rule in Rule::ALL {
        let order = section(rule.page(), "Order").unwrap_or_else(|fault| panic!("{rule}: {fault}"));
        let order = order.replace("\n  ", " ");
        let algebra = rule.algebra();
        let fold = if algebra.associative {
            "`fold`, two at a time in any order, gives what `combine` gives."
        } else {
            "`fold` depends on the order of the sources, and is not what `combine` gives."
        };
        let said: Vec<&str> = order.lines().collect();
        let expected = [
            format!("- Associative: {}. {fold}", word(algebra.associative)),
            format!("- Vacuous source neutral: {}.", word(algebra.vacuous_is_neutral)),
            format!("- Idempotent: {}.", word(algebra.idempotent)),
        ];
        assert_eq!(said.len(), expected.len(), "{rule}");
        for (said, expected) in said.iter().zip(expected) {
            assert!(said.starts_with(&expected), "{rule}: {said}");
        }
    }
}

fn word(holds: bool) -> &'static str {
    if holds { "yes" } else { "no" }
}

/// Sources that bring out every way in which a rule can refuse them.
fn hard_cases() -> Vec<(Frame, Frame, Vec<MassFunction>)> {
    let atoms = ["A", "B"];
    let free = Frame::free(atoms).expect("a frame");
    let shafer = Frame::shafer(atoms).expect("a frame");
    let without_a = Frame::with_empty(atoms, &["A"]).expect("a frame");
    let says = |frame: &Frame, words: &[(&'static str, f64)]| {
        MassFunction::parse(frame, words.iter().copied()).expect("masses")
    };
    let open = |frame: &Frame| vec![says(frame, &[("empty", 0.5), ("Theta", 0.5)]); 2];
    let (a, b) = (says(&shafer, &[("A", 1.0)]), says(&shafer, &[("B", 1.0)]));
    let refuted = vec![says(&free, &[("A", 1.0)]); 2];
    vec![
        (free.clone(), free.clone(), open(&free)),
        (shafer.clone(), shafer.clone(), open(&shafer)),
        (shafer.clone(), shafer.clone(), vec![a, b]),
        (without_a, free, refuted),
        (shafer.clone(), shafer.clone(), many(&shafer)),
    ]
}

/// More products of focal elements than a rule may visit that visits all: 2^27.
fn many(frame: &Frame) -> Vec<MassFunction> {
    vec![MassFunction::parse(frame, [("A", 0.5), ("Theta", 0.5)]).expect("masses"); 27]
}

fn refusals(rule: Rule) -> Vec<&'static str> {
    let refusal = |(frame, given_on, sources): (Frame, Frame, Vec<MassFunction>)| {
        let mut settings = Settings::default();
        if frame != given_on {
            settings = settings.with_source_frame(&given_on);
        }
        rule::combine_with(rule, &sources, &frame, &settings).err().map(|error| error.code())
    };
    hard_cases().into_iter().filter_map(refusal).collect()
}

#[test]
fn the_model_section_names_the_errors_that_arise() {
    let named = [
        ("NotFreeModel", "not_free_model"),
        ("MassOnEmpty", "mass_on_empty"),
        ("TotalConflict", "total_conflict"),
        ("Dogmatic", "dogmatic"),
        ("Normal", "normal"),
        ("TooManyProducts", "too_many_products"),
    ];
    for rule in Rule::ALL {
        let model = section(rule.page(), "Model").unwrap_or_else(|fault| panic!("{rule}: {fault}"));
        let refusals = refusals(rule);
        for (name, code) in named {
            let says =
                model.contains(&format!("(`{name}`)")) || model.contains(&format!(": `{name}`"));
            assert_eq!(says, refusals.contains(&code), "{rule}: {name}");
        }
    }
}

#[test]
fn the_guide_lists_every_rule_with_its_laws_costs_and_numbers() {
    let tables = tables(GUIDE);
    let [table] = tables.as_slice() else { panic!("{} tables", tables.len()) };
    let columns = [
        "what happens to conflict",
        "associative",
        "vacuous neutral",
        "idempotent",
        "on maps",
        "cost",
        "Bel(I)",
        "BetP(I)",
    ];
    assert_eq!(table.columns, columns);
    assert_eq!(table.rows.len(), Rule::ALL.len());
    for ((link, row), rule) in table.rows.iter().zip(Rule::ALL) {
        assert_eq!(*link, format!("[{rule}](../crates/belief/rules/{rule}.md)"));
        let algebra = rule.algebra();
        let laws =
            [algebra.associative, algebra.vacuous_is_neutral, algebra.idempotent, rule.on_maps()];
        assert_eq!(row[1..5], laws.map(word), "{rule}");
        assert!(!row[0].is_empty(), "{rule}");
        let visits_all = refusals(rule).contains(&"too_many_products");
        assert_eq!(row[5] == "k^S", visits_all, "{rule} costs {}", row[5]);
        check_guide_numbers(rule, &row[6..]).unwrap_or_else(|fault| panic!("{rule}: {fault}"));
    }
    check_prose(GUIDE).expect("no number but the table's");
}

fn check_guide_numbers(rule: Rule, row: &[&str]) -> Result<(), String> {
    let frame = Example::Paper.frame(rule.model());
    match rule::combine(rule, &Example::Paper.sources(&frame), &frame) {
        Ok(fused) => ["Bel(I)", "BetP(I)"].iter().zip(row).try_for_each(|(column, cell)| {
            check_number(column, cell, read_off(column, &fused, &frame)?)
        }),
        Err(_) if row == ["–", "–"] => Ok(()),
        Err(error) => Err(format!("{error}, and yet {row:?}")),
    }
}
