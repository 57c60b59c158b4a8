//! Scenario of a structure given by matrices of a finite-element program, and by bars beside them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use asperity_law::{ContactDampingSpec, LawRef, Laws};
use asperity_structure::{DampingSpec, End, ExcitationSpec, PlaceSpec, SensorSpec};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::scenario::{DEFAULT_OUTPUT_RATE_HZ, MAX_OUTPUT_RATE_HZ, Scenario, SchemaId, schema_of};

/// Modes kept of each body by default.
pub const DEFAULT_REDUCED_MODES: usize = 40;

/// Bodies given by their matrices, and bars beside them, with contact patches of many cells, static loads, an
/// excitation and sensors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct StructureScenario {
    /// Version of the scenario format.
    pub schema: SchemaId,
    /// Title, for the reader.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// Bodies, in any order.
    #[schemars(length(min = 1, max = 100))]
    pub bodies: Vec<StructureBodySpec>,
    /// Acceleration of gravity along x, y and z in m/s².
    #[serde(default)]
    pub gravity_m_per_s2: [f64; 3],
    /// Static loads beside gravity.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub loads: Vec<StaticLoadSpec>,
    /// Contact patches.
    #[schemars(length(min = 1, max = 100))]
    pub interfaces: Vec<PatchSpec>,
    /// Springs, with dampers or without, between places of the bodies or on the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub springs: Vec<SpringSpec>,
    /// Displacements that are zero: guides and supports.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schemars(length(max = 1000))]
    pub held: Vec<HeldSpec>,
    /// Contact laws by name, to be shared by interfaces.
    #[serde(default, skip_serializing_if = "Laws::is_empty")]
    pub laws: Laws,
    /// Damping of the bodies: mass-proportional, or Rayleigh.
    pub damping: DampingSpec,
    /// Force on a node.
    #[serde(default)]
    pub excitation: ExcitationSpec,
    /// Sensors, from the first on: results are read at the first, and at the others beside it.
    #[schemars(length(min = 1, max = 100))]
    pub sensors: Vec<SensorSpec>,
    /// Simulated time in s.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub duration_s: f64,
    /// Sample rate of the output in Hz.
    #[serde(default = "default_output_rate")]
    #[schemars(extend("exclusiveMinimum" = 0.0, "maximum" = MAX_OUTPUT_RATE_HZ))]
    pub output_rate_hz: f64,
    /// Relative accuracy of the numbers of a response, the step of time chosen for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1e-6, max = 0.1))]
    pub accuracy: Option<f64>,
    /// Instants of a response that are shown on meshes, and cells that are recorded over time.
    #[serde(default, skip_serializing_if = "OutputSpec::is_default")]
    pub output: OutputSpec,
}

impl StructureScenario {
    /// Files of its bodies, cells and static loads, as given.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        let cells = self.interfaces.iter().filter_map(|patch| patch.cells.as_deref());
        let loads = self.loads.iter().filter_map(|load| load.file.as_deref());
        self.bodies.iter().flat_map(StructureBodySpec::files).chain(cells).chain(loads)
    }
}

/// Instants of a response that are shown on meshes, and cells that are recorded over time.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutputSpec {
    /// Times in s at which the motion of meshes and the pressures of cells are written, each at the nearest sample; six
    /// in the first period of the lowest natural frequency when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(max = 1000), inner(range(min = 0.0)))]
    pub instants_s: Option<Vec<f64>>,
    /// Names of cells that are recorded over time, by the name of their interface; of an interface that is left out, the
    /// cells of the highest and the lowest pressure at rest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub cells: BTreeMap<String, Vec<String>>,
}

impl OutputSpec {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Body given by its matrices, or bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["matrices"]}, {"required": ["bar"]}]))]
pub struct StructureBodySpec {
    /// Name of the body.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Files of its stiffness and mass without contact.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub matrices: Option<MatricesSpec>,
    /// Bar in place of matrices.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bar: Option<BarSpec>,
    /// Deck with the nodes of the mesh: tells rows of internal amplitudes from displacements, names sets, and
    /// makes the reduction faster. File relative to the scenario's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub mesh: Option<String>,
    /// Units of matrices and mesh; metre, kilogram and second when left out.
    #[serde(default)]
    pub units: UnitsSpec,
    /// Modes kept.
    #[serde(default)]
    pub reduction: ReductionSpec,
}

impl StructureBodySpec {
    /// Files of the body, as given.
    fn files(&self) -> impl Iterator<Item = &str> {
        let of_matrices = self.matrices.iter().flat_map(|matrices| {
            let optional = matrices.mass.iter().chain(&matrices.rows);
            std::iter::once(&matrices.stiffness).chain(optional)
        });
        of_matrices.chain(&self.mesh).map(String::as_str)
    }
}

/// Uniform bar that moves along its axis, with exactly one of `area_m2` and `mass_kg`. It does not turn, and its end
/// faces stay plane.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["area_m2"]}, {"required": ["mass_kg"]}]))]
pub struct BarSpec {
    /// Length in m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_m: f64,
    /// Area of the cross-section in m²; give this or `mass_kg`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub area_m2: Option<f64>,
    /// Mass of the bar in kg, with the area mass / (density length); give this or `area_m2`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub mass_kg: Option<f64>,
    /// Young's modulus in Pa.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub youngs_modulus_pa: f64,
    /// Density in kg/m³.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub density_kg_per_m3: f64,
    /// Direction of its axis, from the upper to the lower end, along which its displacements count; its length does not
    /// count.
    #[serde(default = "down")]
    pub direction: [f64; 3],
}

/// Format of files of matrices.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MatricesFormatSpec {
    /// `row column value` a line, one triangle, and a file of rows with `node.direction` a line.
    Calculix,
    /// `node,direction, node,direction, value` a line, or `row column value` with a file of rows.
    Abaqus,
    /// Matrix Market, with a file of rows.
    MatrixMarket,
    /// Nastran DMIG matrices.
    Nastran,
    /// MATLAB file with `K`, `M` and `dof`.
    Matlab,
    /// NumPy file with `K`, `M` and `dof`.
    Npz,
    /// Reduced model: a MATLAB or NumPy file with the full matrices `K` and `M`, closures `W` and areas `area` of cells,
    /// and optionally loads `f` and responses `R`, in SI.
    Reduced,
}

/// Files of stiffness and mass, relative to the scenario's folder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MatricesSpec {
    /// Format of the files.
    pub format: MatricesFormatSpec,
    /// File of the stiffness; of everything, for MATLAB, NumPy and reduced models.
    #[schemars(length(min = 1))]
    pub stiffness: String,
    /// File of the mass; none for one MATLAB or NumPy file of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub mass: Option<String>,
    /// File with the node and the direction of each row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub rows: Option<String>,
}

/// Units of matrices and mesh.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct UnitsSpec {
    /// Metres in a unit of length, 0.001 for millimetres.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub length_m: f64,
    /// Kilograms in a unit of mass, 1000 for tonnes.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub mass_kg: f64,
    /// Seconds in a unit of time.
    #[serde(default = "one")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub time_s: f64,
}

impl Default for UnitsSpec {
    fn default() -> Self {
        Self { length_m: 1.0, mass_kg: 1.0, time_s: 1.0 }
    }
}

/// Reduction of a body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ReductionSpec {
    /// Number of the lowest modes kept, without contact, the rigid ones included. The flexibility of all others
    /// is kept at cells, loads and sensors.
    #[serde(default = "default_modes")]
    #[schemars(range(min = 1, max = 2000))]
    pub modes: usize,
}

impl Default for ReductionSpec {
    fn default() -> Self {
        Self { modes: DEFAULT_REDUCED_MODES }
    }
}

/// Static load: a file of nodal forces, the loads of a reduced model, a force on a node or spread over a set of nodes, or
/// a force on an end of a bar.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    {"required": ["file"]},
    {"required": ["array"]},
    {"required": ["node", "direction", "force_n"]},
    {"required": ["set", "direction", "force_n"]},
    {"required": ["end", "force_n"]}
]))]
pub struct StaticLoadSpec {
    /// Name of the body.
    #[schemars(length(min = 1))]
    pub body: String,
    /// CSV of `node,direction,force_n`, relative to the scenario's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub file: Option<String>,
    /// Array of loads of a reduced model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub array: Option<LoadArray>,
    /// Factor on the forces of the file or the array.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub factor: Option<f64>,
    /// Node on which the force acts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<i64>,
    /// Set of nodes of the mesh over which the force is spread evenly.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub set: Option<String>,
    /// End of a bar on which the force acts, along the axis of the bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<End>,
    /// Direction of the force; its length does not count.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub direction: Option<[f64; 3]>,
    /// Force in N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_n: Option<f64>,
}

/// Contact patch: cells, each with one closure and one pressure, from a file or between two surfaces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["cells"]}, {"required": ["above"]}, {"required": ["array"]}]))]
pub struct PatchSpec {
    /// Name of the interface, used in the headers of the results.
    #[schemars(length(min = 1))]
    pub name: String,
    /// Contact law: a name from "laws", or a law written in place.
    pub law: LawRef,
    /// Name of the body of the cells of a file, unless the file has a column `body`; of the reduced model of an array.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub body: Option<String>,
    /// CSV of `cell,area_m2,node,direction,weight`, relative to the scenario's folder: the closure of a cell
    /// is the sum of weight times displacement.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub cells: Option<String>,
    /// Array of closures of a reduced model, "W": its cells, with the areas of its array `area`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub array: Option<ClosureArray>,
    /// Side whose outward normals point at the other; closures are along them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<SideSpec>,
    /// The other side, whose mesh need not match; rigid ground when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub below: Option<SideSpec>,
    /// Division of the area between the surfaces: "faces", a cell for each face of "above", which is the default, or
    /// \[columns, rows\] of a grid over the patch.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub split: Option<SplitSpec>,
    /// Direction of the columns of the grid in the plane of the patch; when left out the first of x, y, z that is not
    /// near the normal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub along: Option<[f64; 3]>,
    /// Area in m² of a contact between two places, which is one cell: ends of bars, nodes or sets of nodes. Surfaces have
    /// their own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub area_m2: Option<f64>,
    /// Viscous damping of every cell; none when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub damping: Option<ContactDampingSpec>,
    /// Gap between the faces before they are loaded in m; negative for an interference.
    #[serde(default)]
    pub initial_gap_m: f64,
}

/// Static loads of a reduced model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum LoadArray {
    /// The array `f`.
    #[serde(rename = "f")]
    F,
}

/// Closures of a reduced model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum ClosureArray {
    /// The array `W`.
    W,
}

/// Spring between two places, or between a place and the ground: its elongation is the displacement of `from` less
/// that of `to`, each along its own direction. It has no force before the loads are on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpringSpec {
    /// One end.
    pub from: PlaceSpec,
    /// The other end; the ground when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<PlaceSpec>,
    /// Stiffness in N/m.
    #[schemars(extend("exclusiveMinimum" = 0.0))]
    pub stiffness_n_per_m: f64,
    /// Viscous damping in N s/m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0.0))]
    pub damping_n_s_per_m: Option<f64>,
}

/// Displacements of a node, or of all nodes of a set, that are zero along an axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [{"required": ["node"]}, {"required": ["set"]}]))]
pub struct HeldSpec {
    /// Name of the body.
    #[schemars(length(min = 1))]
    pub body: String,
    /// Node that is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<i64>,
    /// Set of nodes of the mesh that are held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub set: Option<String>,
    /// Direction: along x, y or z.
    pub direction: [f64; 3],
}

/// A side of a contact patch: a surface, an end of a bar, or with the `area_m2` of the interface a node or the mean of the
/// nodes of a set.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(extend("oneOf" = [
    {"required": ["surface"]},
    {"required": ["set"]},
    {"required": ["end"]},
    {"required": ["node"]}
]))]
pub struct SideSpec {
    /// Name of the body; it has a mesh for a surface or a set.
    #[schemars(length(min = 1))]
    pub body: String,
    /// Surface of element faces of its mesh (`*SURFACE, TYPE=ELEMENT`).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub surface: Option<String>,
    /// Set of nodes of its mesh: the free faces all nodes of which are in it; with the `area_m2` of the interface the
    /// mean of its nodes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(length(min = 1))]
    pub set: Option<String>,
    /// End of a bar.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<End>,
    /// Node, with the `area_m2` of the interface.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub node: Option<i64>,
}

/// Division of a patch into cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum SplitSpec {
    /// A cell for each face.
    Faces(SplitFaces),
    /// Columns and rows of a grid.
    Grid(#[schemars(inner(range(min = 1, max = 1000)))] [usize; 2]),
}

/// The word "faces".
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SplitFaces {
    /// A cell for each face of the surface above.
    Faces,
}

/// A scenario of bars, or of a structure of matrices.
#[derive(Debug, Clone, PartialEq)]
pub enum AnyScenario {
    /// Bars and their interfaces.
    Bars(Box<Scenario>),
    /// A structure of matrices, and bars beside them, with its patches.
    Structure(Box<StructureScenario>),
}

impl AnyScenario {
    /// Title.
    pub fn title(&self) -> Option<&str> {
        match self {
            Self::Bars(bars) => bars.title.as_deref(),
            Self::Structure(structure) => structure.title.as_deref(),
        }
    }

    /// Numbers of bodies and of interfaces.
    pub fn size(&self) -> (usize, usize) {
        match self {
            Self::Bars(bars) => (bars.bodies.len(), bars.interfaces.len()),
            Self::Structure(structure) => (structure.bodies.len(), structure.interfaces.len()),
        }
    }
}

/// JSON Schema (draft 2020-12) of a structure given by matrices.
pub fn structure_schema() -> &'static Value {
    static SCHEMA: LazyLock<Value> = LazyLock::new(schema_of::<StructureScenario>);
    &SCHEMA
}

fn down() -> [f64; 3] {
    [0.0, 0.0, -1.0]
}

fn one() -> f64 {
    1.0
}

fn default_modes() -> usize {
    DEFAULT_REDUCED_MODES
}

fn default_output_rate() -> f64 {
    DEFAULT_OUTPUT_RATE_HZ
}
