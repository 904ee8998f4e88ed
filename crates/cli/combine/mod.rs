//! `wisdom combine`: belief functions for scripts, a case a line.

mod answer;
mod case;
mod json;
pub(crate) mod operation;

use std::borrow::Cow;
use std::io::{BufRead, Read, Write};
use std::process::ExitCode;

use serde::Serialize;

use answer::Answer;
use case::{Case, CaseError, Id};

/// No case needs more: a source of a million focal elements is a tenth of it.
const MAX_LINE_BYTES: usize = 64 << 20;

/// Characters of a message that are kept at most: it says what is wrong, and need not repeat all of it.
const MAX_MESSAGE_CHARS: usize = 500;

/// What editors put before UTF-8, and JSON does not know.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Combine belief functions: read cases as JSON lines, write one line of JSON for each.
#[derive(clap::Args, Debug)]
#[command(after_help = SHORT_HELP, after_long_help = LONG_HELP)]
pub(crate) struct CombineArgs {
    /// List all operations, one a line, with the params each knows, and leave.
    #[arg(long)]
    operations: bool,
}

const SHORT_HELP: &str = "\
What a case is made of: wisdom combine --help. All there is to know: docs/combine.md.";

const LONG_HELP: &str = "\
A case is one line of standard input, a JSON object:
  frame         names of the atoms: [\"A\", \"B\"]
  model         \"shafer\" (atoms exclude each other), \"free\" (all may overlap)
                or {\"empty\": [expressions]} (all may overlap but these)
  rule          the operation: a rule of combination, such a rule with
                _sequential after its name (two sources at a time, from the
                left), or another; --operations lists them with their params
  sources       list of {expression: mass}; the masses of a source sum to 1
  params        {name: value}, where the operation has any
  keys          list of the expressions asked for, each once; without, masses
                are answered for all elements, other values for each atom
  source_model  the model on which the sources spoke, if not the same
  id            anything; it comes back as it was written
Sources may be left out only of cardinality and hyper_power_size; an empty
list of them combines to total ignorance. Other fields are errors, but for
those that describe published cases: source, expected, tolerance, verified,
note.

Expressions: atoms, & (binds tighter than |), parentheses, empty, Theta.

The answer is one line, in the order of the cases:
  {\"id\": id, \"result\": {expression: number}}
  {\"id\": id, \"result\": {\"value\": number}}    where one number is asked for
  {\"id\": id, \"error\": kind, \"message\": text, \"line\": number}
An error never stops the lines after it. Its kind is one word: malformed,
unknown_rule, sum_not_one, total_conflict and so on. Empty lines are passed
over; a line holds at most 64 MiB.

Example:
  echo '{\"frame\": [\"A\", \"B\"], \"model\": \"shafer\", \"rule\": \"pcr5\",
         \"sources\": [{\"A\": 0.6, \"A|B\": 0.4}, {\"B\": 0.3, \"A|B\": 0.7}]}' |
    tr -d '\\n' | wisdom combine

Operations, params and kinds of errors one by one: docs/combine.md.

Exit code 0 when every line was answered, be it by an error; 1 when reading
or writing failed.";

pub(crate) fn run(args: &CombineArgs) -> anyhow::Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    if args.operations {
        for operation in operation::list() {
            writeln!(out, "{operation}")?;
        }
        return Ok(ExitCode::SUCCESS);
    }
    let mut input = std::io::stdin().lock();
    let mut line = Vec::new();
    for number in 1_u64.. {
        line.clear();
        let limit = MAX_LINE_BYTES as u64 + 1;
        if input.by_ref().take(limit).read_until(b'\n', &mut line)? == 0 {
            break;
        }
        if line.len() > MAX_LINE_BYTES && line.last() != Some(&b'\n') {
            skip_line(&mut input)?;
            let error = CaseError::malformed("a line of more than 64 MiB".to_owned());
            write_line(&mut out, &Reply::error(None, &error, number))?;
            continue;
        }
        let text = bare(&line, number);
        if !text.trim_ascii().is_empty() {
            write_line(&mut out, &reply(text, number))?;
        }
    }
    out.flush()?;
    Ok(ExitCode::SUCCESS)
}

fn skip_line(input: &mut impl BufRead) -> std::io::Result<()> {
    loop {
        let ahead = input.fill_buf()?;
        let (used, done) = match ahead.iter().position(|&byte| byte == b'\n') {
            Some(end) => (end + 1, true),
            None => (ahead.len(), ahead.is_empty()),
        };
        input.consume(used);
        if done {
            return Ok(());
        }
    }
}

/// A line without what belongs to the file and not to the case: the mark at its start, the ends of its lines.
fn bare(line: &[u8], number: u64) -> &[u8] {
    let line = line.strip_suffix(b"\n").unwrap_or(line);
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    if number == 1 { line.strip_prefix(BYTE_ORDER_MARK).unwrap_or(line) } else { line }
}

/// A line of output.
#[derive(Serialize)]
#[serde(untagged)]
enum Reply {
    Answer { id: Id, result: Answer },
    Error { id: Id, error: &'static str, message: String, line: u64 },
}

impl Reply {
    fn error(id: Id, CaseError { code, message }: &CaseError, line: u64) -> Self {
        Self::Error { id, error: code, message: shortened(message).into_owned(), line }
    }
}

fn reply(line: &[u8], number: u64) -> Reply {
    let (id, case) = Case::read(line);
    match case.and_then(|case| operation::answer(&case)) {
        Ok(result) => Reply::Answer { id, result },
        Err(error) => Reply::error(id, &error, number),
    }
}

/// In one piece, so that whoever has read a line has read all of it.
fn write_line(out: &mut impl Write, reply: &Reply) -> anyhow::Result<()> {
    let mut line = serde_json::to_vec(reply)?;
    line.push(b'\n');
    Ok(out.write_all(&line)?)
}

/// A message without its middle, if it is long: the place of a fault is named at its start, what would have been
/// right at its end.
fn shortened(message: &str) -> Cow<'_, str> {
    let half = MAX_MESSAGE_CHARS / 2;
    if message.chars().nth(MAX_MESSAGE_CHARS).is_none() {
        return Cow::Borrowed(message);
    }
    let boundary = |(at, _): (usize, char)| at;
    let head = message.char_indices().nth(half).map_or(message.len(), boundary);
    let tail = message.char_indices().nth_back(half - 2).map_or(0, boundary);
    Cow::Owned(format!("{}…{}", &message[..head], &message[tail..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_long_messages_lose_their_middle() {
        let short = "é".repeat(MAX_MESSAGE_CHARS);
        assert_eq!(shortened(&short), short);
        let long = shortened(&format!("a{short}z")).into_owned();
        assert_eq!(long.chars().count(), MAX_MESSAGE_CHARS);
        assert!(long.starts_with("aé") && long.ends_with("éz") && long.contains("é…é"));
    }

    #[test]
    fn a_line_is_bared_of_what_the_file_adds() {
        assert_eq!(bare("\u{feff}{}\r\n".as_bytes(), 1), b"{}");
        assert_eq!(bare(b"{}", 1), b"{}");
        assert_eq!(bare("\u{feff}{}\n".as_bytes(), 2), "\u{feff}{}".as_bytes());
    }
}
