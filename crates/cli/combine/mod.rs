//! `wisdom combine`: belief functions for scripts, a case a line.

mod answer;
mod case;
mod operation;

use std::io::{BufRead, Read, Write};
use std::process::ExitCode;

use serde_json::{Value, json};

use case::{Case, CaseError};

/// No case needs more: a source of a million focal elements is a tenth of it.
const MAX_LINE_BYTES: usize = 64 << 20;

/// Combine belief functions: reads cases as JSON lines and writes one line of JSON for each.
///
/// A case is an object with `frame` (names of the atoms), `model` ("free", "shafer" or {"empty": [expressions]}),
/// `rule` (a rule of `wisdom rules`, such a rule with `_sequential` after its name, or another operation; see
/// below), `sources` (a list of {expression: mass}), and where needed `params`, `source_model`, `keys` (the
/// expressions asked for) and `id`. The answer is {"id": …, "result": {expression: value}}, with a single number
/// under `value`, or {"id": …, "error": kind, "message": text}; an error never stops the lines after it.
#[derive(clap::Args, Debug)]
#[command(after_help = AFTER_HELP)]
pub(crate) struct CombineArgs {
    /// Print the names of all operations and leave.
    #[arg(long)]
    operations: bool,
}

const AFTER_HELP: &str = "\
Expressions: atoms, & (binds tighter than |), parentheses, empty, Theta. Lines of at most 64 MB.

Example:
  echo '{\"frame\": [\"A\", \"B\"], \"model\": \"shafer\", \"rule\": \"pcr5\",
         \"sources\": [{\"A\": 0.6, \"A|B\": 0.4}, {\"B\": 0.3, \"A|B\": 0.7}]}' | tr -d '\\n' | wisdom combine

Exit code 0 when every line was answered, be it by an error; 1 when reading or writing failed.";

pub(crate) fn run(args: &CombineArgs) -> anyhow::Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    if args.operations {
        for (name, summary) in operation::list() {
            writeln!(out, "{name:26} {summary}")?;
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
            let error = CaseError::malformed("a line of more than 64 MB".to_owned());
            serde_json::to_writer(&mut out, &refusal(&Value::Null, &error, number))?;
            out.write_all(b"\n")?;
            continue;
        }
        if line.trim_ascii().is_empty() {
            continue;
        }
        write_answer(&mut out, &line, number)?;
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

fn write_answer(out: &mut impl Write, line: &[u8], number: u64) -> anyhow::Result<()> {
    let outcome = Case::read(line).and_then(|case| {
        let answer = operation::answer(&case).map_err(|error| error.of(case.id.clone()))?;
        Ok((case.id, answer))
    });
    match outcome {
        Ok((id, answer)) => {
            // By hand, so that elements keep their order.
            write!(out, "{{\"id\":{id},\"result\":")?;
            serde_json::to_writer(&mut *out, &answer)?;
            out.write_all(b"}\n")?;
        }
        Err(error) => writeln!(out, "{}", refusal(&error.id, &error, number))?,
    }
    Ok(())
}

fn refusal(id: &Value, error: &CaseError, line: u64) -> Value {
    json!({ "id": id, "error": error.code, "message": error.message, "line": line })
}
