//! Forms of a frequency response function, and quantities of a response.

/// The form of a frequency response function: its numerator and denominator.
///
/// With the harmonic displacement `U`, velocity `i w U`, acceleration
/// `-w^2 U` and force `F`, `w = 2 pi f`. Names and order follow
/// D. J. Ewins, *Modal Testing: Theory, Practice and Application*, 2nd ed.,
/// Research Studies Press 2000, table 1.1, and ISO 7626-1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FrfForm {
    /// Displacement over force, `H = U / F` \[m/N\].
    Receptance,
    /// Velocity over force, `i w H` \[m/(N s)\].
    Mobility,
    /// Acceleration over force, `-w^2 H` \[m/(N s^2)\], which is 1/kg.
    Accelerance,
    /// Force over displacement, `1 / H` \[N/m\].
    DynamicStiffness,
    /// Force over velocity, `1 / (i w H)` \[N s/m\].
    MechanicalImpedance,
    /// Force over acceleration, `-1 / (w^2 H)` in kg.
    ApparentMass,
}

impl FrfForm {
    /// The six forms, motion over force first.
    pub const ALL: [Self; 6] = [
        Self::Receptance,
        Self::Mobility,
        Self::Accelerance,
        Self::DynamicStiffness,
        Self::MechanicalImpedance,
        Self::ApparentMass,
    ];

    /// The unit, as written on an axis.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Receptance => "m/N",
            Self::Mobility => "m/(N s)",
            Self::Accelerance => "m/(N s^2)",
            Self::DynamicStiffness => "N/m",
            Self::MechanicalImpedance => "N s/m",
            Self::ApparentMass => "kg",
        }
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Receptance => "receptance",
            Self::Mobility => "mobility",
            Self::Accelerance => "accelerance",
            Self::DynamicStiffness => "dynamic stiffness",
            Self::MechanicalImpedance => "mechanical impedance",
            Self::ApparentMass => "apparent mass",
        }
    }

    /// True for force over motion.
    pub const fn is_inverse(self) -> bool {
        matches!(self, Self::DynamicStiffness | Self::MechanicalImpedance | Self::ApparentMass)
    }

    /// Order of the time derivative of the displacement: 0, 1 or 2.
    pub const fn derivatives(self) -> i32 {
        match self {
            Self::Receptance | Self::DynamicStiffness => 0,
            Self::Mobility | Self::MechanicalImpedance => 1,
            Self::Accelerance | Self::ApparentMass => 2,
        }
    }
}

impl std::fmt::Display for FrfForm {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.pad(self.name())
    }
}

/// Quantity of the response samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ResponseKind {
    /// Displacement from equilibrium, in metres.
    Displacement,
    /// Velocity, in m/s; its transform is `i 2 pi f` times the transform of displacement.
    Velocity,
    /// Acceleration, in m/s^2; its transform is `-(2 pi f)^2` times the transform of displacement.
    Acceleration,
}

impl ResponseKind {
    /// Order of the time derivative of the displacement: 0, 1 or 2.
    pub const fn derivatives(self) -> i32 {
        self.form().derivatives()
    }

    /// Form of response over force: receptance, mobility or accelerance.
    pub const fn form(self) -> FrfForm {
        match self {
            Self::Displacement => FrfForm::Receptance,
            Self::Velocity => FrfForm::Mobility,
            Self::Acceleration => FrfForm::Accelerance,
        }
    }

    /// The name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}
