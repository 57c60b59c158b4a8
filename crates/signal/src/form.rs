//! The six forms of a frequency response function.

/// What a frequency response function divides by what.
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
    /// All six, motion over force first.
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

    /// Whether force is divided by motion, not motion by force.
    pub const fn is_inverse(self) -> bool {
        matches!(self, Self::DynamicStiffness | Self::MechanicalImpedance | Self::ApparentMass)
    }

    /// Time derivatives of the displacement in the motion: 0, 1 or 2.
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

/// What the response samples are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum ResponseKind {
    /// Displacement from equilibrium, in metres.
    Displacement,
    /// Velocity, in m/s, divided by `i 2 pi f` in the spectrum.
    Velocity,
    /// Acceleration, in m/s^2, divided by `-(2 pi f)^2` in the spectrum.
    Acceleration,
}

impl ResponseKind {
    /// Time derivatives of the displacement in the samples: 0, 1 or 2.
    pub const fn derivatives(self) -> i32 {
        self.form().derivatives()
    }

    /// What the samples' transform over the force's is: receptance, mobility or accelerance.
    pub const fn form(self) -> FrfForm {
        match self {
            Self::Displacement => FrfForm::Receptance,
            Self::Velocity => FrfForm::Mobility,
            Self::Acceleration => FrfForm::Accelerance,
        }
    }

    /// The samples' name in running text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }
}
