//! Input decks of finite-element programs: sets and faces name nodes that the deck has.
#![no_main]

use asperity_matrices::Deck;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let Ok(deck) = Deck::of_text("deck", &String::from_utf8_lossy(data)) else { return };
    for name in deck.node_set_names() {
        let nodes = deck.node_set(name).expect("a set of the deck");
        assert!(nodes.iter().all(|node| deck.nodes().contains(*node)));
    }
    for name in deck.surface_names() {
        let faces = deck.surface(name).unwrap_or_default();
        assert!(faces.iter().flat_map(|face| &face.nodes).all(|node| deck.nodes().contains(*node)));
    }
});
