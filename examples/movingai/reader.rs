//! Octile maps and scenarios of the `MovingAI` benchmarks (Sturtevant 2012), and the ground that a map is.

use wisdom_grid::{Cell, GridSpec, Raster};
use wisdom_planner::{Ground, PlannerError, Traversability, Vehicle};
use wisdom_terrain::Layer;

/// What is wrong with a file, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct ReadError {
    /// The file, as the user named it.
    pub(crate) file: String,
    /// The line, from 1.
    pub(crate) line: usize,
    /// What is there.
    pub(crate) found: String,
    /// What should be there.
    pub(crate) expected: String,
}

impl std::fmt::Display for ReadError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { file, line, found, expected } = self;
        write!(f, "{file}, line {line}: found {found}; expected {expected}")
    }
}

impl std::error::Error for ReadError {}

/// A problem of a scenario: the shortest way between two free cells of its map.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Problem {
    pub(crate) start: Cell,
    pub(crate) goal: Cell,
    /// Published length of the shortest way; a diagonal step counts √2 and needs both cells beside it free.
    pub(crate) length: f64,
}

/// The lines of a file, with what is needed to complain about one.
struct Lines<'a> {
    file: &'a str,
    lines: Vec<&'a str>,
}

impl<'a> Lines<'a> {
    fn new(file: &'a str, text: &'a str) -> Self {
        Self { file, lines: text.lines().collect() }
    }

    fn error(
        &self,
        index: usize,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ReadError {
        let (found, expected) = (found.into(), expected.into());
        ReadError { file: self.file.to_owned(), line: index + 1, found, expected }
    }

    /// A line by its index from 0.
    fn line(&self, index: usize, expected: &str) -> Result<&'a str, ReadError> {
        let line = self.lines.get(index).copied();
        line.ok_or_else(|| self.error(index, "the end of the file", expected))
    }

    /// The words of a line that must begin with a key.
    fn keyed(&self, index: usize, key: &str, expected: &str) -> Result<Vec<&'a str>, ReadError> {
        let line = self.line(index, expected)?;
        let mut words = line.split_whitespace();
        if words.next() == Some(key) {
            return Ok(words.collect());
        }
        Err(self.error(index, quoted(line), expected))
    }

    fn side(&self, index: usize, key: &str) -> Result<usize, ReadError> {
        let expected = format!("`{key}` and a number from 1 to {}", wisdom_grid::MAX_SIDE);
        let words = self.keyed(index, key, &expected)?;
        let side = match words[..] {
            [number] => number.parse().ok(),
            _ => None,
        };
        side.filter(|side| (1..=wisdom_grid::MAX_SIDE).contains(side))
            .ok_or_else(|| self.error(index, quoted(self.lines[index]), expected))
    }
}

/// A text as an error shows it: long lines are cut.
fn quoted(text: &str) -> String {
    const SHOWN: usize = 60;
    let cut: String = text.chars().take(SHOWN).collect();
    if cut.len() < text.len() { format!("`{cut}…`") } else { format!("`{cut}`") }
}

/// Reads a map: the cells that are blocked.
///
/// `.` and `G` are free; `@`, `O` and `T` are blocked. Swamp (`S`) and water (`W`) are refused: how they may be
/// crossed differs between users of the benchmarks.
pub(crate) fn read_map(file: &str, text: &str) -> Result<Raster<bool>, ReadError> {
    const HEADER: usize = 4;
    let lines = Lines::new(file, text);
    if lines.keyed(0, "type", "`type octile`")? != ["octile"] {
        return Err(lines.error(0, quoted(lines.lines[0]), "`type octile`"));
    }
    let (rows, cols) = (lines.side(1, "height")?, lines.side(2, "width")?);
    if !lines.keyed(3, "map", "`map`")?.is_empty() {
        return Err(lines.error(3, quoted(lines.lines[3]), "`map`"));
    }
    let mut blocked = Vec::with_capacity((rows * cols).min(text.len()));
    for row in HEADER..HEADER + rows {
        let line = lines.line(row, &format!("row {} of {rows}", row + 1 - HEADER))?;
        for (col, sign) in line.chars().enumerate() {
            blocked.push(match sign {
                '.' | 'G' => false,
                '@' | 'O' | 'T' => true,
                _ => {
                    let found = format!("`{sign}` at column {}", col + 1);
                    return Err(lines.error(
                        row,
                        found,
                        "`.` or `G` (free), `@`, `O` or `T` (blocked)",
                    ));
                }
            });
        }
        let found = blocked.len() - (row - HEADER) * cols;
        if found != cols {
            let found = format!("{found} cells");
            return Err(lines.error(row, found, format!("{cols}, the width of the map")));
        }
    }
    let rest = lines.lines.iter().enumerate().skip(HEADER + rows);
    if let Some((row, line)) = rest.into_iter().find(|(_, line)| !line.trim().is_empty()) {
        return Err(lines.error(row, quoted(line), format!("the end: the map has {rows} rows")));
    }
    let spec = GridSpec::new(rows, cols, 1.0).expect("the sides were checked");
    Ok(Raster::from_vec(spec, blocked).expect("the rows were counted"))
}

/// Reads the problems of a scenario on a map.
pub(crate) fn read_scenario(
    file: &str,
    text: &str,
    blocked: &Raster<bool>,
) -> Result<Vec<Problem>, ReadError> {
    const FIELDS: &str = "bucket, map, width, height, start x, start y, goal x, goal y and length";
    let lines = Lines::new(file, text);
    let version = lines.keyed(0, "version", "`version 1`")?;
    if !matches!(version[..], ["1" | "1.0"]) {
        return Err(lines.error(0, quoted(lines.lines[0]), "`version 1`"));
    }
    let spec = blocked.spec();
    let mut problems = Vec::new();
    for (index, line) in lines.lines.iter().enumerate().skip(1) {
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.is_empty() {
            continue;
        }
        let &[_bucket, _map, width, height, start_x, start_y, goal_x, goal_y, length] = &words[..]
        else {
            return Err(lines.error(
                index,
                format!("{} fields", words.len()),
                format!("9: {FIELDS}"),
            ));
        };
        let number = |name: &str, word: &str| {
            let expected = format!("{name}, a whole number");
            word.parse::<usize>().map_err(|_| lines.error(index, quoted(word), expected))
        };
        let (cols, rows) = (number("the width", width)?, number("the height", height)?);
        if (cols, rows) != (spec.cols(), spec.rows()) {
            let found = format!("a map of {cols} x {rows}");
            let expected =
                format!("{} x {} (width x height), as the map has", spec.cols(), spec.rows());
            return Err(lines.error(index, found, expected));
        }
        let cell = |name: &str, x: &str, y: &str| {
            let cell = Cell {
                col: number(&format!("{name} x"), x)?,
                row: number(&format!("{name} y"), y)?,
            };
            let at = format!("the {name} at x {}, y {}", cell.col, cell.row);
            if !spec.contains(cell) {
                let expected = format!("x below {cols} and y below {rows}");
                return Err(lines.error(index, at, expected));
            }
            if blocked[cell] {
                return Err(lines.error(index, format!("{at}, which is blocked"), "a free cell"));
            }
            Ok(cell)
        };
        let (start, goal) = (cell("start", start_x, start_y)?, cell("goal", goal_x, goal_y)?);
        let length = length
            .parse::<f64>()
            .ok()
            .filter(|length| length.is_finite() && *length >= 0.0)
            .ok_or_else(|| lines.error(index, quoted(length), "a length of 0 or more"))?;
        problems.push(Problem { start, goal, length });
    }
    Ok(problems)
}

/// Flat ground with the blocked cells of a map and a hazard of one per metre: −ln R of a route is its length.
pub(crate) fn ground(blocked: Raster<bool>) -> Result<Traversability, PlannerError> {
    let spec = blocked.spec();
    let ground = Ground {
        elevation: Layer::certain(Raster::filled(spec, 0.0)).expect("zero is a height"),
        blocked,
        severity: Raster::filled(spec, 0.0),
        hazard_per_m: Raster::filled(spec, 1.0),
    };
    Traversability::from_ground(&Vehicle::default(), ground)
}
