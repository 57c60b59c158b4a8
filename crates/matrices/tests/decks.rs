//! Input decks: meshes that tests write, with each fault that is named.

use asperity_matrices::{Deck, ElementKind, MatrixUnits};

type Outcome = Result<(), Box<dyn std::error::Error>>;

/// A cube of eight nodes, with sets and surfaces in all notations.
const CUBE: &str = "\
*HEADING
a cube, with a comma, in the title
** a comment
*Node, nset=Nall
1, 0, 0, 0
2, 1., 0.
3, 1.0E0, 1.D0, 0
 4 , 0 , 1 , 0
5,0,0,1
6,1,0,1
7,1,1,1
8,0,1,1
*ELEMENT, TYPE=C3D8I, ELSET=cube
10, 1, 2, 3, 4,
5, 6, 7, 8
*ELEMENT, TYPE=SPRINGA, ELSET=spring
11, 1, 7
*NSET, NSET=ODD, GENERATE
1, 7, 2
*NSET, NSET=some
ODD, 8,
*NSET, NSET=OF_SPRING, ELSET=Spring
*ELSET, ELSET=ALL,
GENERATE
10, 11
*SURFACE, NAME=top, TYPE=ELEMENT
CUBE, S2
*SURFACE, NAME=SIDE
10, s4
*SURFACE, NAME=POINTS, TYPE=NODE
NALL
*TRANSFORM, NSET=OF_SPRING
1,1,0, -1,1,0
*MATERIAL, NAME=STEEL
*ELASTIC
210000, 0.3
*STEP
*NODE FILE
U
*END STEP
";

#[test]
fn nodes_elements_sets_and_surfaces_are_read() -> Outcome {
    let mut deck = Deck::of_text("cube.inp", CUBE)?;
    assert_eq!(deck.nodes().count(), 8);
    assert_eq!(deck.nodes().get(3), Some([1.0, 1.0, 0.0]));
    assert_eq!(deck.nodes().get(9), None);
    let kinds: Vec<_> = deck.elements().iter().map(|element| element.kind).collect();
    assert_eq!(kinds, [ElementKind::Hexahedron8, ElementKind::Other]);
    assert_eq!(deck.node_set("Nall")?, [1, 2, 3, 4, 5, 6, 7, 8]);
    assert_eq!(deck.node_set("odd")?, [1, 3, 5, 7]);
    assert_eq!(deck.node_set("SOME")?, [1, 3, 5, 7, 8]);
    assert_eq!(deck.node_set("OF_SPRING")?, [1, 7]);
    assert_eq!(deck.element_set("all")?, [10, 11]);
    let top = deck.surface("TOP")?;
    assert_eq!((top[0].element, top[0].face, top[0].corners()), (10, 2, &[5, 6, 7, 8][..]));
    assert_eq!(deck.surface("side")?[0].nodes, [2, 3, 7, 6]);
    assert_eq!(deck.transformed_nodes(), [1, 7]);
    assert_eq!(deck.surface_names().collect::<Vec<_>>(), ["POINTS", "SIDE", "TOP"]);
    deck.convert(MatrixUnits::new(1e-3, 1e3, 1.0)?);
    assert_eq!(deck.nodes().get(7), Some([1e-3; 3]));
    Ok(())
}

#[test]
fn a_quadratic_element_takes_as_many_lines_as_it_needs() -> Outcome {
    let nodes: String =
        (1..=20).map(|node| format!("{node}, {node}, 0, 0\n")).collect::<Vec<_>>().concat();
    let element = "*ELEMENT, TYPE=C3D20R\n1,1,2,3,4,5,6,7,8,9,10\n11,12,13,14,15,16,17,18,19,20\n";
    let surface = "*SURFACE, NAME=A, TYPE=ELEMENT\n1,S1\n";
    let deck = Deck::of_text("a.inp", &format!("*NODE\n{nodes}{element}{surface}"))?;
    let face = &deck.surface("A")?[0];
    assert_eq!(face.nodes, [1, 4, 3, 2, 12, 11, 10, 9]);
    assert_eq!(face.corners(), [1, 4, 3, 2]);
    Ok(())
}

#[test]
fn names_that_the_deck_does_not_have_are_answered_with_those_it_has() -> Outcome {
    let deck = Deck::of_text("cube.inp", CUBE)?;
    let error = deck.node_set("TOP").unwrap_err().to_string();
    assert_eq!(error, "cube.inp: no node set TOP; the deck has NALL, ODD, OF_SPRING, SOME");
    let error = deck.surface("BOTTOM").unwrap_err().to_string();
    assert_eq!(error, "cube.inp: no surface BOTTOM; the deck has POINTS, SIDE, TOP");
    let error = deck.surface("points").unwrap_err().to_string();
    let expected = "cube.inp: the surface points is given by TYPE=NODE (line 30)";
    assert!(error.starts_with(expected), "{error}");
    Ok(())
}

#[test]
fn faults_are_named_with_file_and_line() {
    let cases = [
        ("*HEADING", "*PART, NAME=A", "cube.inp, line 1: *PART cannot be read; write a flat deck"),
        (
            "*HEADING",
            "*INSTANCE, NAME=A-1, PART=A",
            "cube.inp, line 1: *INSTANCE cannot be read; write a flat",
        ),
        ("*HEADING", "*NGEN", "cube.inp, line 1: *NGEN cannot be read; write every node"),
        (
            "*HEADING",
            "*INCLUDE, INPUT=mesh.inp",
            "cube.inp, line 1: *INCLUDE of `mesh.inp` cannot be read",
        ),
        (
            "nset=Nall",
            "nset=Nall, SYSTEM=C",
            "cube.inp, line 4: *NODE with SYSTEM=C cannot be read",
        ),
        ("2, 1., 0.", "2, 1., x", "cube.inp, line 6: `2, 1., x`; expected `node, x, y, z`"),
        ("2, 1., 0.", "1, 1., 0.", "cube.inp, line 6: `1, 1., 0.`; expected each node once"),
        (
            "5, 6, 7, 8\n",
            "5, 6, 7, 9\n",
            "cube.inp, line 15: element 10 has the node 9; expected nodes with a place",
        ),
        (
            "5, 6, 7, 8\n",
            "5, 6, 7, 8, 1\n",
            "cube.inp, line 15: element 10 with 9 nodes; expected 8 nodes",
        ),
        (
            "5, 6, 7, 8\n",
            "5, 6, 7\n",
            "cube.inp, line 16: element 10 with 7 nodes; expected 8 nodes",
        ),
        ("11, 1, 7", "10, 1, 7", "cube.inp, line 17: element 10 again; expected each element once"),
        ("*ELEMENT, TYPE=SPRINGA", "*ELEMENT", "cube.inp, line 16: *ELEMENT without TYPE"),
        ("1, 7, 2", "7, 1, 2", "cube.inp, line 19: `7, 1, 2`; expected `first, last, step`"),
        (
            "ODD, 8,",
            "EVEN, 8,",
            "cube.inp, line 21: `EVEN` in the set SOME; expected the number of a node",
        ),
        (
            "ODD, 8,",
            "ODD, 9,",
            "cube.inp, line 21: node 9 in the set SOME; expected a node that the deck has",
        ),
        (
            "ODD, 8,",
            "SOME, 8,",
            "cube.inp, line 21: `SOME` in the set SOME; expected sets of at most",
        ),
        (
            "CUBE, S2",
            "CUBE, S7",
            "cube.inp, line 27: the face `S7` of element 10; expected a face of the element, S1 to S6",
        ),
        (
            "CUBE, S2",
            "SPRING, S1",
            "cube.inp, line 27: the face `S1` of element 11; expected a solid element",
        ),
        (
            "CUBE, S2",
            "CUBES, S2",
            "cube.inp, line 27: `CUBES` in the surface TOP; expected the number of an element",
        ),
        ("CUBE, S2", "12, S2", "cube.inp, line 27: element 12 in the surface TOP"),
        ("CUBE, S2", "CUBE", "cube.inp, line 27: `CUBE`; expected `element, face`"),
        ("*TRANSFORM, NSET=OF_SPRING", "*TRANSFORM, NSET=A", "cube.inp, line 32: no node set A"),
    ];
    for (old, new, expected) in cases {
        let error = Deck::of_text("cube.inp", &CUBE.replacen(old, new, 1)).unwrap_err().to_string();
        assert!(error.starts_with(expected), "{error}\n{expected}");
    }
    let error = Deck::of_text("a.inp", "hello\n").unwrap_err().to_string();
    assert_eq!(error, "a.inp: no nodes; expected *NODE and lines `number, x, y, z`");
}

#[test]
fn included_files_are_read_beside_the_deck() -> Outcome {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("deck.inp");
    std::fs::write(&path, "*INCLUDE, INPUT=mesh.inp\n*NSET, NSET=A\n2\n")?;
    std::fs::write(folder.path().join("mesh.inp"), "*NODE\n1,0,0,0\n2,1,0,0\n")?;
    assert_eq!(Deck::read(&path)?.node_set("A")?, [2]);
    std::fs::write(folder.path().join("mesh.inp"), "*NODE\n1,0,0,0\n2,1,0,x\n")?;
    let error = Deck::read(&path).unwrap_err().to_string();
    assert!(error.contains("mesh.inp, line 3: `2,1,0,x`"), "{error}");
    std::fs::write(folder.path().join("mesh.inp"), "*INCLUDE, INPUT=deck.inp\n")?;
    let error = Deck::read(&path).unwrap_err().to_string();
    assert!(error.contains("expected files that do not include each other in a circle"), "{error}");
    std::fs::remove_file(folder.path().join("mesh.inp"))?;
    let error = Deck::read(&path).unwrap_err().to_string();
    assert!(error.contains("deck.inp, line 1: *INCLUDE of `mesh.inp`"), "{error}");
    Ok(())
}

/// From above a corner of a cube the edges are seen that do not end in the opposite one; along an axis, those of one face.
#[test]
fn edges_turned_away_are_not_seen() -> Outcome {
    let deck = Deck::of_text("cube.inp", CUBE)?;
    let all = deck.free_edges();
    assert_eq!(all.len(), 12);
    for (eye, opposite) in [([1.0, 1.0, 1.0], 1), ([-1.0, -2.0, -0.5], 7), ([1.0, -1.0, 2.0], 4)] {
        let seen: Vec<[i64; 2]> =
            all.iter().copied().filter(|edge| !edge.contains(&opposite)).collect();
        assert_eq!(deck.edges_seen(eye), seen, "{eye:?}");
    }
    assert_eq!(deck.edges_seen([0.0, 0.0, 1.0]), [[5, 6], [5, 8], [6, 7], [7, 8]]);
    Ok(())
}
