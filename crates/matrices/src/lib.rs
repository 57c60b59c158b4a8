//! Matrices and meshes of finite-element programs.
//!
//! A structure without contact has the equation of motion
//!
//! ```text
//! M u'' + K u = f,        u(row) = displacement of the degree of freedom of the row
//! ```
//!
//! with the symmetric matrices `K` and `M` of `n` rows. [`read()`] takes them, with the node and the
//! direction of each row, from the files of a finite-element program:
//!
//! | format | files |
//! |---|---|
//! | [CalculiX](MatricesFormat::Calculix) | `.sti`, `.mas`, `.dof` of `*FREQUENCY, SOLVER=MATRIXSTORAGE` |
//! | [Abaqus](MatricesFormat::Abaqus) | `.mtx` of `*MATRIX OUTPUT`, formats MATRIX INPUT and COORDINATE |
//! | [Matrix Market](MatricesFormat::MatrixMarket) | `.mtx`, coordinate, symmetric or general |
//! | [Nastran](MatricesFormat::Nastran) | `DMIG` entries of a punch file or of bulk data |
//! | [MATLAB](MatricesFormat::Matlab) | `.mat` of versions 5 to 7, sparse or full |
//! | [NumPy](MatricesFormat::Npz) | `.npz`, among them systems of SDynPy |
//!
//! [`read_reduced`] takes a reduced model: dense matrices with the closure rows `W` of contact cells.
//! [`read_cells`] and [`read_loads`] take the cells of contact patches and nodal forces from CSV;
//! [`Deck`] holds nodes, elements, sets and surfaces of an input deck of CalculiX or Abaqus, and
//! [`SurfaceCells`] divides the contact between two surfaces into cells.
//!
//! # Units
//! Matrices are in the units of their files. [`Matrices::convert`] and [`Deck::convert`] turn them into
//! metre, kilogram and second. A stiffness of two displacements is in N/m, of a displacement and a rotation
//! in N, of two rotations in N m; masses accordingly in kg, kg m and kg m^2.
//!
//! # Trust
//! Readers check each number, row and count before it is used, take no memory that the size of the file does
//! not warrant, and name file and line of what they refuse. [`Matrices::findings`] names what is
//! readable, and yet wrong or surprising: negative diagonals, rows without stiffness, motions without mass.

mod abaqus;
mod arrays;
mod calculix;
mod cells;
mod contact_surface;
mod deck;
mod dense;
mod dof;
mod element_kind;
mod error;
mod face_shape;
mod findings;
mod labelled;
mod matlab;
mod matrices;
mod matrix_market;
mod nastran;
mod nodes;
mod npz;
mod number_type;
mod polygon;
mod read;
mod reduced;
mod rigid_motions;
mod sparse;
mod surface_cells;
mod text;
mod units;
mod vtu;

pub use cells::{CellWeight, ContactCell, NodalForce, read_cells, read_loads};
pub use contact_surface::ContactSurface;
pub use deck::{Deck, MeshElement, SurfaceFace};
pub use dense::DenseMatrix;
pub use dof::Dof;
pub use element_kind::ElementKind;
pub use error::{MatricesError, Place};
pub use findings::MatrixFinding;
pub use matrices::Matrices;
pub use nodes::Nodes;
pub use read::{MatricesFormat, MatrixFiles, read, read_bytes};
pub use reduced::{ReducedModel, read_reduced};
pub use rigid_motions::RigidMotions;
pub use sparse::SparseSymmetric;
pub use surface_cells::{PatchSplit, SurfaceCells};
pub use units::MatrixUnits;
pub use vtu::VtuGrid;
