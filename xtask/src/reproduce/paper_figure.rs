//! One figure: its table, its numbers and its drawing.

use anyhow::Result;
use asperity_table::Table;

use super::rig::Rig;

/// One figure of the paper.
pub(crate) struct PaperFigure {
    /// Short name: file name, and what `--only` takes.
    pub(crate) id: &'static str,
    /// Title in the report.
    pub(crate) title: &'static str,
    /// Content of the figure, its computation, and data that the paper does not publish.
    pub(crate) caption: &'static str,
    /// Computes the table, and the numbers behind the claims by claim id.
    pub(crate) compute: fn(&Rig) -> Result<Computed>,
    /// Draws the table as SVG.
    pub(crate) draw: fn(&Table) -> Result<String>,
}

/// Result of a figure.
pub(crate) struct Computed {
    /// The figure's numbers: its CSV, and all that the drawing reads.
    pub(crate) table: Table,
    /// The number behind each claim that this figure settles.
    pub(crate) values: Vec<(&'static str, f64)>,
}

/// Columns of a table to be.
#[derive(Default)]
pub(crate) struct Columns(Vec<(String, Vec<f64>)>);

impl Columns {
    /// Adds a column.
    pub(crate) fn push(&mut self, name: impl Into<String>, values: impl Into<Vec<f64>>) {
        self.0.push((name.into(), values.into()));
    }

    /// The result of a figure without claims. Columns shorter than the longest end in NaN.
    pub(crate) fn computed(self) -> Result<Computed> {
        let rows = self.0.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
        let mut table = Table::new();
        for (name, mut values) in self.0 {
            values.resize(rows, f64::NAN);
            table.push(name, values)?;
        }
        Ok(Computed { table, values: Vec::new() })
    }
}

/// A figure, done.
pub(crate) struct Finished {
    pub(crate) figure: &'static PaperFigure,
    pub(crate) table: Table,
    pub(crate) svg: String,
}
