//! Every text must be accepted or refused. Accepted statements must print as an equivalent text.

use crate::suite::{Failure, Tally};
use zeroset_ir::{Graph, NodeId};
use zeroset_parser::Limits;
use zeroset_syntax::{Document, Options, Patch, parse, read, read_bytes};

/// Small limits, so that a fuzzer loses little time on texts that expand to large graphs.
const LIMITS: Limits = Limits {
    bytes: 1 << 16,
    symbols: 10_000,
    depth: 200,
    nodes: 1 << 12,
    surfaces: 1000,
    curves: 100,
};

/// Limits for reading printed text. It nests deeper, since signs and powers get brackets.
const PRINTED: Limits = Limits {
    bytes: 1 << 20,
    symbols: 100_000,
    depth: 3 * LIMITS.depth,
    nodes: 1 << 16,
    surfaces: 1000,
    curves: 100,
};

/// Reads `data` and renders its diagnostics. Then prints the statements and reads them again: trees
/// and graph must be the same. In the tally, `defined` counts accepted texts.
///
/// # Errors
/// A difference, and the text.
///
/// # Panics
/// If the parser panics.
pub fn read_and_print(data: &[u8]) -> Result<Tally, Failure> {
    let options = Options { limits: LIMITS, ..Options::default() };
    let document = read_bytes(data, &options);
    let Ok(text) = std::str::from_utf8(data) else {
        let Err(errors) = document else {
            return Err(Failure::new(format!("accepted, but not UTF-8: {data:?}")));
        };
        errors.render(None, &String::from_utf8_lossy(data), false);
        return Ok(Tally { compared: 1, defined: 0 });
    };
    let fail = |what: &str| Failure::new(format!("{what}\n{text:?}"));
    match document {
        Ok(document) => {
            well_formed(&document, text).map_err(|what| fail(&what))?;
            let printed = printed(text).map_err(|what| fail(&what))?;
            same_graph(&document, &printed, &options).map_err(|what| fail(&what))?;
            Ok(Tally { compared: 1, defined: 1 })
        }
        Err(errors) => {
            if errors.iter().next().is_none() {
                return Err(fail("refused without a reason"));
            }
            for error in &errors {
                if text.get(error.span.range()).is_none() || error.message().is_empty() {
                    return Err(fail(&format!("an error without place or message: {error:?}")));
                }
            }
            errors.render(Some("file.zset"), text, true);
            Ok(Tally { compared: 1, defined: 0 })
        }
    }
}

fn well_formed(document: &Document, text: &str) -> Result<(), String> {
    let patches = &document.patches;
    if document.surfaces.is_empty() && document.curves.is_empty() && patches.all.is_empty() {
        return Err("nothing to draw, yet accepted".to_owned());
    }
    for note in &document.notes {
        if text.get(note.span.range()).is_none() {
            return Err(format!("a note about no place: {note:?}"));
        }
        note.render(None, text, true);
    }
    let beyond = document.surfaces.iter().find(|s| s.root.index() >= document.graph.len());
    if let Some(surface) = beyond {
        return Err(format!("a surface without a function: {surface:?}"));
    }
    let is_beyond = |root: NodeId| root.index() >= patches.graph.len();
    let beyond = patches.all.iter().find(|patch| patch.roots().any(is_beyond));
    beyond.map_or(Ok(()), |patch| Err(format!("a patch without a function: {}", patch.echo)))
}

/// Prints the statements of `text`. Fails if the printed text reads as other trees.
fn printed(text: &str) -> Result<String, String> {
    let statements = parse(text, &LIMITS).map_err(|errors| format!("not parsed: {errors}"))?;
    let lines: Vec<String> = statements.iter().map(ToString::to_string).collect();
    let printed = lines.join("\n");
    let again =
        parse(&printed, &PRINTED).map_err(|errors| format!("printed as {printed:?}: {errors}"))?;
    if again == statements {
        Ok(printed)
    } else {
        Err(format!("printed as {printed:?}, which reads as {again:?}, not {statements:?}"))
    }
}

fn same_graph(document: &Document, printed: &str, options: &Options<'_>) -> Result<(), String> {
    let options = Options { limits: PRINTED, ..*options };
    let again = read(printed, &options).map_err(|errors| format!("{printed:?}: {errors}"))?;
    let nodes = |graph: &Graph| graph.iter().map(|(_, node)| node.clone()).collect::<Vec<_>>();
    let roots = |document: &Document| document.surfaces.iter().map(|s| s.root).collect::<Vec<_>>();
    let patches = |document: &Document| -> Vec<NodeId> {
        document.patches.all.iter().flat_map(Patch::roots).collect()
    };
    let same = nodes(&document.graph) == nodes(&again.graph)
        && roots(document) == roots(&again)
        && nodes(&document.patches.graph) == nodes(&again.patches.graph)
        && patches(document) == patches(&again);
    if same { Ok(()) } else { Err(format!("printed as {printed:?}, it is another graph")) }
}
