//! Files of npTDMS and files written by hand; see PROVENANCE.md beside the former.
#![allow(clippy::unwrap_used, reason = "tests build valid files")]

use std::fs::File;
use std::io::Cursor;

use asperity_measure::tdms_file::{
    TdmsError, TdmsFile, TdmsObject, TdmsOptions, TdmsPath, TdmsSelection, TdmsValue,
};

fn reference(name: &str) -> TdmsFile<File> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/reference/measure/");
    TdmsFile::open(File::open(format!("{folder}{name}")).unwrap(), &TdmsOptions::default()).unwrap()
}

#[test]
fn objects_with_all_their_properties() {
    let file = reference("hits.tdms");
    let hammer = file.find("/'Hit 1'/'hammer'").unwrap();
    let object = &file.objects()[hammer];
    assert_eq!(object.path(), &TdmsPath::Channel("Hit 1".into(), "hammer".into()));
    let number = |name: &str| object.property(name).unwrap().number().unwrap();
    assert_eq!((number("wf_increment"), number("wf_start_offset")), (1.0 / 51_200.0, -0.001));
    let start = object.property("wf_start_time").unwrap();
    assert_eq!(start.time().unwrap().to_string(), "2026-11-01T10:00:00.250000Z");
    let description = object.properties().find(|(name, _)| *name == "description").unwrap().1;
    assert_eq!(description.value, TdmsValue::Text("tip: steel".into()));
    assert!(file.find("/'Dr. T''s hit'/'ham''mer'").is_some());
    assert_eq!(file.cut_off(), None);
    assert!(reference("incremental.tdms").cut_off().is_some());
}

#[test]
fn properties_not_kept_are_left_out_but_those_of_scales() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/reference/measure/");
    let bytes = std::fs::read(format!("{folder}scales.tdms")).unwrap();
    let options = TdmsOptions { keep: |_| false, ..TdmsOptions::default() };
    let file = TdmsFile::open(Cursor::new(bytes), &options).unwrap();
    let names = file.objects().iter().flat_map(TdmsObject::properties);
    let names: Vec<&str> = names.map(|(name, _)| name).collect();
    assert!(!names.is_empty() && names.iter().all(|name| name.starts_with("NI_")), "{names:?}");
}

#[test]
fn selections_in_blocks_are_the_whole_samples() {
    for name in ["hits.tdms", "scales.tdms", "interleaved.tdms", "incremental.tdms", "types.tdms"] {
        let mut file = reference(name);
        let numeric = |id: &usize| {
            let object = &file.objects()[*id];
            object.samples() > 0 && object.other_content().is_none()
        };
        let channels: Vec<usize> = (0..file.objects().len()).filter(numeric).collect();
        let mut selection = TdmsSelection::default();
        for id in &channels {
            file.select(&mut selection, *id).unwrap();
        }
        let mut joined = vec![Vec::new(); channels.len()];
        loop {
            let columns = file.read(&mut selection, 5).unwrap();
            if columns.iter().all(Vec::is_empty) {
                break;
            }
            joined.iter_mut().zip(columns).for_each(|(whole, block)| whole.extend(block));
        }
        for (id, joined) in channels.into_iter().zip(joined) {
            assert_eq!(joined.len() as u64, file.objects()[id].samples(), "{name}");
            // Again and again: only selections count towards the limit of memory.
            for _ in 0..50 {
                assert_eq!(file.samples(id).unwrap(), joined, "{name}");
            }
        }
    }
}

#[test]
fn objects_without_numbers_cannot_be_selected() {
    let mut file = reference("hits.tdms");
    let (group, texts) = (file.find("/'Hit 1'").unwrap(), "its values are texts");
    let of_texts = |object: &TdmsObject| object.other_content() == Some(texts);
    let remarks = file.objects().iter().position(of_texts).unwrap();
    for object in [group, remarks, 1000] {
        let error = file.samples(object).unwrap_err();
        assert!(matches!(error, TdmsError::NotNumeric { object: found, .. } if found == object));
    }
}

#[test]
fn errors_have_the_offset() {
    let open = |bytes: &[u8]| {
        TdmsFile::open(Cursor::new(bytes), &TdmsOptions::default()).unwrap_err().to_string()
    };
    let lead_in = |contents: u8, lengths: [u8; 2]| {
        let mut bytes = [b"TDSm\0\0\0\0\x69\x12\0\0".as_slice(), &[0; 16]].concat();
        (bytes[4], bytes[12], bytes[20]) = (contents, lengths[0], lengths[1]);
        bytes
    };
    assert_eq!(open(b"TDSm"), "byte 0: the lead-in of a segment needs 28 bytes; the file has 4");
    assert_eq!(open(&[0; 28]), "byte 0: the tag of a segment is `\\0\\0\\0\\0`; expected `TDSm`");
    let beyond = [lead_in(0, [0, 0]), lead_in(0, [9, 0])].concat();
    assert_eq!(open(&beyond), "byte 56: a segment needs 9 bytes; the file has 0");
    let driver = lead_in(0x80, [0, 0]);
    assert!(open(&driver).starts_with("raw data of NI-DAQmx cannot be read; save"));
    // 65535 objects in 4 bytes.
    let objects = [lead_in(2, [4, 4]), vec![0xff, 0xff, 0, 0]].concat();
    let message = "byte 32: the objects of a segment needs 786420 bytes; the file has 0";
    assert_eq!(open(&objects), message);
}
