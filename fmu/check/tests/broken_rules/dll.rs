//! A library for Windows, byte by byte: the smallest one that exports functions and needs
//! libraries.

/// Address of the only section in memory.
const BASE: u32 = 0x1000;
/// Offset of the section in the file.
const FILE: usize = 0x200;

fn put(bytes: &mut Vec<u8>, numbers: &[u32]) {
    for number in numbers {
        bytes.extend(number.to_le_bytes());
    }
}

/// Makes a library for x86-64 with these functions, which needs these libraries.
pub(super) fn dll(functions: &[&str], libraries: &[&str]) -> Vec<u8> {
    let count = functions.len() as u32;
    // Export directory, addresses, names, ordinals; import descriptors; then all texts.
    let addresses = BASE + 40;
    let names = addresses + 4 * count;
    let ordinals = names + 4 * count;
    let imports = (ordinals + 2 * count).next_multiple_of(4);
    let texts = imports + 20 * (libraries.len() as u32 + 1);
    let mut text = Vec::new();
    let mut place = |name: &str| {
        let at = texts + text.len() as u32;
        text.extend(name.as_bytes());
        text.push(0);
        at
    };
    let mut section = Vec::new();
    put(&mut section, &[0, 0, 0, place("good.dll"), 1, count, count, addresses, names, ordinals]);
    // An address inside the directory would mark a forwarder.
    put(&mut section, &vec![2 * BASE; functions.len()]);
    // The loader searches names by bisection: they have to be sorted.
    let mut sorted = functions.to_vec();
    sorted.sort_unstable();
    for name in &sorted {
        put(&mut section, &[place(name)]);
    }
    for index in 0..count as u16 {
        section.extend(index.to_le_bytes());
    }
    section.resize((imports - BASE) as usize, 0);
    for name in libraries {
        put(&mut section, &[texts, 0, 0, place(name), texts]);
    }
    put(&mut section, &[0; 5]);
    section.extend(text);

    let mut file = b"MZ".to_vec();
    file.resize(0x3c, 0);
    put(&mut file, &[0x40]);
    file.extend(b"PE\0\0");
    file.extend(0x8664u16.to_le_bytes());
    file.extend(1u16.to_le_bytes());
    put(&mut file, &[0, 0, 0]);
    file.extend(240u16.to_le_bytes());
    // A 64-bit image that is a library.
    file.extend(0x2022u16.to_le_bytes());
    file.extend(0x20bu16.to_le_bytes());
    file.extend([0; 2]);
    put(&mut file, &[0, 0, 0, 0, BASE]);
    put(&mut file, &[0x1000_0000, 0, 0x1000, 0x200]);
    put(&mut file, &[6, 0, 6, 0, 0x3000, FILE as u32, 0, 2]);
    put(&mut file, &[0; 8]);
    put(&mut file, &[0, 16]);
    // The directory of exports has to hold the names as well.
    let size = section.len() as u32;
    put(&mut file, &[BASE, size, imports, texts - imports]);
    put(&mut file, &[0; 28]);
    file.extend(b".edata\0\0");
    put(&mut file, &[size, BASE, size, FILE as u32, 0, 0, 0, 0x4000_0040]);
    file.resize(FILE, 0);
    file.extend(section);
    file
}
