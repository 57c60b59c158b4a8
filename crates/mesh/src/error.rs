//! Errors of meshes and component modes.

/// A structure, its grid or its component modes cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A quantity that must be positive and finite is not.
    #[error("{owner}: {quantity} is {value}; it must be positive and finite")]
    NotPositive {
        /// The body, interface or support concerned.
        owner: String,
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
    },
    /// A quantity that may be zero but not negative is negative or not finite.
    #[error("{owner}: {quantity} is {value}; it must be finite and not negative")]
    Negative {
        /// The body, interface or support concerned.
        owner: String,
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
    },
    /// A stack needs at least one body.
    #[error("a stack needs at least one body")]
    NoBodies,
    /// There must be one interface below each body.
    #[error("{bodies} bodies need as many interfaces, one below each; {interfaces} were given")]
    InterfaceCount {
        /// Number of bodies.
        bodies: usize,
        /// Number of interfaces.
        interfaces: usize,
    },
    /// The Courant number violates Eq. (3).
    #[error(
        "the Courant number is {courant}; the explicit scheme is stable only between 0 and 1 (Eq. 3)"
    )]
    Courant {
        /// The Courant number `c dt / dx` given.
        courant: f64,
    },
    /// No mode, or more than are accepted, would be kept of a body.
    #[error("{body}: {modes} modes; accepted: 1 to {limit}")]
    ModeCount {
        /// The body concerned.
        body: String,
        /// The count given.
        modes: usize,
        /// The most accepted.
        limit: usize,
    },
    /// The frequencies of interest need more modes of a body than are accepted.
    #[error(
        "{body}: the frequencies of interest reach {ratio:.3e} times its first natural frequency, for which {limit} modes are too few; a slower force or a given number of modes is accepted"
    )]
    FrequencyBound {
        /// The body concerned.
        body: String,
        /// Highest frequency of interest over that of the body's first elastic mode.
        ratio: f64,
        /// Most modes accepted.
        limit: usize,
    },
    /// Modal data do not fit together.
    #[error("modal data with {found} entries where there is one for each of {ports} ports")]
    ModalSize {
        /// Entries found.
        found: usize,
        /// Number of ports.
        ports: usize,
    },
    /// A contact or guide is at a port that the structure does not have.
    #[error("port {port} does not exist; the structure has {ports}, counted from 0")]
    NoPort {
        /// The port.
        port: usize,
        /// Number of ports.
        ports: usize,
    },
    /// A port is not on the stack.
    #[error("the {quantity} of a port is {value}; accepted: 0 to {most}")]
    Port {
        /// The quantity, with its unit.
        quantity: &'static str,
        /// The value given.
        value: f64,
        /// The most accepted.
        most: f64,
    },
    /// A mass or stiffness matrix is not usable.
    #[error("the {matrix} matrix is {problem}")]
    Matrix {
        /// The matrix.
        matrix: &'static str,
        /// The condition that it does not meet.
        problem: &'static str,
    },
    /// A degree of freedom is not in the matrices.
    #[error("degree of freedom {dof} does not exist; the matrices have {size}, counted from 0")]
    DegreeOfFreedom {
        /// The degree of freedom.
        dof: usize,
        /// Size of the matrices.
        size: usize,
    },
    /// The cell is so small that the grid would not fit in memory.
    #[error("cells of {cell_m} m make {nodes:.3e} nodes; at most {limit:.0e} are accepted")]
    TooManyNodes {
        /// The cell length given \[m\].
        cell_m: f64,
        /// The nodes this would take.
        nodes: f64,
        /// The most that is accepted.
        limit: f64,
    },
}

pub(crate) fn positive(owner: &str, quantity: &'static str, value: f64) -> Result<f64, MeshError> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(MeshError::NotPositive { owner: owner.to_owned(), quantity, value })
    }
}

pub(crate) fn not_negative(
    owner: &str,
    quantity: &'static str,
    value: f64,
) -> Result<f64, MeshError> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(MeshError::Negative { owner: owner.to_owned(), quantity, value })
    }
}
