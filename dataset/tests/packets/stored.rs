//! Captures in data sets.

use super::*;

#[test]
fn a_data_set_keeps_its_firings_and_names_the_packet_that_is_broken() {
    let dir = tempfile::tempdir().unwrap();
    let set = dir.path().join("set");
    let known = Known { robot: "car".to_owned(), ..Known::default() };
    let firings = drive(100, 7800.0);
    let recorded = Some(Arc::new(firings.clone()));
    let log = Log { known: Arc::new(known), firings: recorded, ..Log::default() };
    let mut dataset = Dataset { log, ..Dataset::default() };
    store::write(&dataset, &set).unwrap();
    let first = store::read(&set).unwrap();
    assert!(compare(&firings, first.log.firings.as_ref().unwrap()) < 2e-9);
    // What was read is read again to the bit.
    store::write(&first, &set).unwrap();
    assert_eq!(store::read(&set).unwrap(), first);

    let pcap = set.join("lidar.pcap");
    let mut bytes = std::fs::read(&pcap).unwrap();
    bytes.truncate(FILE_HEADER + 2 * PACKET + 100);
    std::fs::write(&pcap, &bytes).unwrap();
    let error = store::read(&set).unwrap_err().to_string();
    assert!(error.contains("lidar.pcap: packet 3: the file seems to have been cut short"), "{error}");
    bytes.truncate(FILE_HEADER + 2 * PACKET);
    std::fs::write(&pcap, &bytes).unwrap();
    let tally = store::read_and_count(&set).unwrap().1.unwrap();
    assert_eq!(tally.packets, 2);

    // Unfit firings touch nothing.
    dataset.log.firings = Some(Arc::new(Firings { t_s: vec![-1.0; 100], ..firings }));
    let refused = store::write(&dataset, &set).unwrap_err().to_string();
    assert!(refused.contains("lidar.pcap: firing 0: its time must lie from 0"), "{refused}");
    assert_eq!(std::fs::read(&pcap).unwrap(), bytes);
    // Nor do firings of another unit than the data set tells of.
    let velodyne = Velodyne {
        vertical_angles_rad: vec![-0.4, 0.0],
        firing_rate_hz: 7800.0,
        turn_rate_hz: 10.0,
        sensor_height_m: 2.0,
        left_m: Vec::new(),
        up_m: Vec::new(),
    };
    dataset.log.firings = first.log.firings;
    dataset.log.known = Arc::new(Known { velodyne: Some(velodyne), ..(*dataset.log.known).clone() });
    let refused = store::write(&dataset, &set).unwrap_err().to_string();
    assert!(
        refused.contains("dataset.toml: vertical_angles_rad must have 64, as lidar.pcap has lasers, values, not 2")
    );
    assert_eq!(std::fs::read(&pcap).unwrap(), bytes);
    dataset.log.firings = None;
    store::write(&dataset, &set).unwrap();
    assert!(!pcap.exists());
}
