//! Recognizes statements of other systems that only style or show a picture.

use crate::program_words::Words;
use zeroset_parser::lex::token::{Token, bracketed, closing, split};
use zeroset_parser::lex::token_kind::TokenKind::*;

/// Words before the options of a command, as in `axis equal` and `title('A surface')`.
#[rustfmt::skip] // several words a line
const COMMANDS: &[&str] = &[
    "axis", "colormap", "shading", "lighting", "camlight", "material", "colorbar", "grid", "box",
    "title", "xlabel", "ylabel", "zlabel", "xlim", "ylim", "zlim", "daspect", "pbaspect",
    "print", "fig2plotly", "set", "unset", "pause", "disp", "drawnow", "rotate3d", "figure",
    "hold", "axes", "light", "legend", "view", "Export", "size", "subplot", "Graphics3d", "clf",
    "patch", "isonormals", "isocaps", "gca", "gcf", "show", "lightangle", "caxis",
];

/// Objects whose members only style or show a picture.
const OBJECTS: &[&str] = &["plt", "ax", "fig", "console", "settings", "plotter", "pl", "display"];

/// Beginnings of the lines about the picture in a Surfer file.
const SURFER_LINES: &[&str] =
    &["camera_", "light_", "background_", "surface_", "rotation_", "scale_", "transform_"];

/// Lines of a Surfer file that begin in the same way but hold formulas, which are read.
const SURFER_FORMULAS: [&str; 2] = ["surface_equation", "surface_parameter_"];

/// Methods that only show or save a picture.
const METHODS: &[&str] = &["show", "save", "savefig", "print"];

impl Words<'_> {
    /// Returns whether a statement only styles or shows a picture.
    pub(crate) fn is_style(self, tokens: &[Token]) -> bool {
        // MATLAB ends a command by a comma, too: `axis equal, box on`.
        let are_styles = || {
            let parts = split(tokens, Comma);
            !parts.is_empty() && parts.iter().all(|part| self.is_one_style(part))
        };
        self.is_one_style(tokens) || tokens.iter().any(|token| token.kind == Comma) && are_styles()
    }

    fn is_one_style(self, tokens: &[Token]) -> bool {
        let start = match tokens {
            [_, equals, value, _, ..] if equals.kind == Equals && self.word(*value) == "patch" => 2,
            _ => 0,
        };
        let Some((first, rest)) = tokens[start..].split_first() else { return false };
        let word = self.word(*first);
        if let [dot, name, ..] = rest
            && self.is_dot(*dot)
            && name.kind.is_name()
        {
            let is_plot = matches!(self.word(*name), "plot" | "scatter" | "contour");
            return OBJECTS.contains(&word) && !is_plot || self.is_style_tail(rest);
        }
        let begins = |list: &[&str]| list.iter().any(|begin| word.starts_with(begin));
        if rest.first().is_some_and(|next| next.kind == Equals)
            && begins(SURFER_LINES)
            && !begins(&SURFER_FORMULAS)
        {
            return self.text.contains(SURFER_FORMULAS[0]);
        }
        if !COMMANDS.contains(&word) {
            return false;
        }
        let has_text = || rest.iter().any(|token| token.kind == Unknown);
        let is_formula = |token: &Token| {
            token.kind.is_operator() && !matches!(token.kind, Comma | Minus) || token.kind == Caret
        };
        match rest.first() {
            None => !first.kind.is_setting() && word != "box",
            // The hints give `axes on` and the ranges of a domain.
            Some(_) if self.is_of_axes(tokens) => false,
            // In `view 4, 3, 6`, the numbers are the eye's position without the word `eye`.
            Some(next)
                if word == "view"
                    && next.span.start > first.span.end
                    && rest.iter().filter(|token| token.kind == Comma).count() == 2 =>
            {
                false
            }
            Some(next) if next.kind == OpenParen || next.kind == OpenBracket => {
                closing(rest).is_some_and(|end| end + 1 == rest.len())
                    && (!matches!(word, "box" | "grid" | "axes" | "light") || has_text())
            }
            // A word of this language's settings takes other words too.
            Some(next) => {
                let is_option = next.kind.is_name() && !first.kind.is_setting();
                (is_option || next.kind == Unknown) && !rest.iter().any(is_formula)
            }
        }
    }

    /// Returns whether a statement switches the axes or sets the range of one.
    fn is_of_axes(self, tokens: &[Token]) -> bool {
        match tokens {
            // MATLAB's `axis off` is a style.
            [first, second] => {
                self.word(*first) == "axis"
                    && matches!(self.word(*second), "on" | "off")
                    && !self.text.contains("meshgrid(")
            }
            [first, open, inner, ..] => {
                matches!(self.word(*first), "xlim" | "ylim" | "zlim")
                    && open.kind == OpenParen
                    && inner.kind == OpenBracket
            }
            _ => false,
        }
    }

    /// Returns whether `tokens`, after a plot, only show or save it, as in `.save("a.png")`.
    pub(crate) fn is_style_tail(self, tokens: &[Token]) -> bool {
        match tokens {
            [] => true,
            [end] if matches!(end.kind, Unknown | Colon) => true,
            [dot, name, rest @ ..] if self.is_dot(*dot) && METHODS.contains(&self.word(*name)) => {
                bracketed(rest).is_some_and(|(_, rest)| self.is_style_tail(rest))
            }
            _ => false,
        }
    }
}
