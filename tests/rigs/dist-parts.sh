# What users install, put together from a program and the library of the FMUs that are built already: archive, .deb, image.
# Times are $SOURCE_DATE_EPOCH, owners root, names sorted: the same inputs give the same bytes.

# What a rig makes to throw away is packed with little work: COMPRESSION is the level of gzip and xz then, from 0 to 9.

# packed FOLDER NAME: a tar archive of FOLDER/NAME on standard output.
packed() {
  tar -C "$1" --sort=name --format=gnu --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX \
    --mtime="@$SOURCE_DATE_EPOCH" -cf - "$2"
}

# third_parties SOURCE: names, versions and licences of the packages in the program.
third_parties() {
  echo "Packages of others in this program, with their licences; their texts are at https://crates.io."
  echo
  (cd "$1" && cargo tree --locked -p octant -p octant-fmu --features octant/full -e normal --prefix none \
    --no-dedupe -f '{p}: {l}') | grep -v '(/' | sed 's/ (proc-macro)//' | LC_ALL=C sort -u
}

# archive SOURCE PROGRAM LIBRARY PACKER FOLDER NAME: makes FOLDER/NAME.tar.gz, and leaves FOLDER/NAME beside it. PACKER is the
# same program for this machine, which writes manual pages and completions.
archive() {
  local source=$1 program=$2 library=$3 packer=$4 folder=$5 name=$6 tree shell
  tree=$folder/$name
  rm -rf "$tree"
  mkdir -p "$tree"/{bin,lib/octant,share/man/man1,share/octant,share/doc/octant} \
    "$tree"/share/{bash-completion/completions,zsh/site-functions,fish/vendor_completions.d}
  # Symbols are a third of a program of the release profile.
  strip_copy "$program" "$tree/bin/octant"
  strip_copy "$library" "$tree/lib/octant/$(basename "$library")"
  chmod 755 "$tree/bin/octant"
  chmod 644 "$tree/lib/octant/"*
  "$packer" man "$tree/share/man/man1" >/dev/null
  "$packer" completions bash >"$tree/share/bash-completion/completions/octant"
  "$packer" completions zsh >"$tree/share/zsh/site-functions/_octant"
  "$packer" completions fish >"$tree/share/fish/vendor_completions.d/octant.fish"
  cp -r "$source/fixtures/scenarios" "$tree/share/octant/"
  cp "$source"/{README.md,CHANGELOG.md,LICENSE-MIT,LICENSE-APACHE} "$tree/share/doc/octant/"
  third_parties "$source" >"$tree/share/doc/octant/THIRD-PARTY.txt"
  packed "$folder" "$name" | gzip "-${COMPRESSION:-9}n" >"$folder/$name.tar.gz"
}

# strip_copy FILE COPY: without symbols. A profile that leaves none is copied as it is, whatever its machine.
strip_copy() {
  if readelf -WS "$1" | grep -q ' \.symtab '; then strip -o "$2" "$1"; else cp "$1" "$2"; fi
}

# debian TREE ARCHITECTURE FOLDER: makes FOLDER/octant_VERSION_ARCHITECTURE.deb of an unpacked archive.
debian() {
  local tree=$1 architecture=$2 folder=$3 stage version
  version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
  stage=$(mktemp -d)
  chmod 755 "$stage"
  mkdir "$stage/DEBIAN"
  cp -r "$tree" "$stage/usr"
  gzip -9n "$stage"/usr/share/man/man1/*.1 "$stage/usr/share/doc/octant/CHANGELOG.md"
  mv "$stage/usr/share/doc/octant/CHANGELOG.md.gz" "$stage/usr/share/doc/octant/changelog.gz"
  mkdir -p "$stage/usr/share/zsh/vendor-completions"
  mv "$stage/usr/share/zsh/site-functions/_octant" "$stage/usr/share/zsh/vendor-completions/"
  rmdir "$stage/usr/share/zsh/site-functions"
  { printf 'Octant: MIT or Apache-2.0, as you like.\n\n'; cat "$tree"/share/doc/octant/{LICENSE-MIT,LICENSE-APACHE,THIRD-PARTY.txt}; } \
    >"$stage/usr/share/doc/octant/copyright"
  rm "$stage"/usr/share/doc/octant/{LICENSE-MIT,LICENSE-APACHE,THIRD-PARTY.txt}
  cat >"$stage/DEBIAN/control" <<END
Package: octant
Version: $version
Section: science
Priority: optional
Architecture: $architecture
Depends: libc6 (>= ${GLIBC:-2.17})
Installed-Size: $(du -ks --apparent-size "$stage/usr" | cut -f1)
Maintainer: The Octant developers <octant@example.invalid>
Description: test harness for the self-calibration of inertial navigation systems
 Simulates a dual-axis rotational inertial navigation system, runs a calibration
 core through a sequence of positions, injects faults, and scores the result
 against the truth, with evidence that others can check.
END
  (cd "$stage" && find usr -type f -print0 | LC_ALL=C sort -z | xargs -0 md5sum >DEBIAN/md5sums)
  chmod -R u=rwX,go=rX "$stage"
  dpkg-deb --root-owner-group -Zxz ${COMPRESSION:+-z$COMPRESSION} --build "$stage" "$folder/octant_${version}_$architecture.deb" >/dev/null
  rm -rf "$stage"
}

# image TREE GLIBC FOLDER NAME: makes the OCI image FOLDER/NAME.oci.tar, tag "octant:VERSION", of an unpacked archive and of
# Debian's C library and certificates in a folder, without an engine. Nothing else is in it.
image() {
  local tree=$1 glibc=$2 folder=$3 name=$4 root layout time version library
  version=$(sed -n 's/^version = "\(.*\)"/\1/p' Cargo.toml | head -n 1)
  root=$(mktemp -d)
  layout=$root/layout
  time=$(date -u -d "@$SOURCE_DATE_EPOCH" +%Y-%m-%dT%H:%M:%SZ)
  mkdir -p "$root/root"/{etc,tmp,work,proc,dev}
  cp -r "$tree" "$root/root/usr"
  mkdir -p "$root/root/lib/x86_64-linux-gnu" "$root/root/lib64"
  for library in ld-linux-x86-64.so.2 libc.so.6 libm.so.6 libdl.so.2 libpthread.so.0 librt.so.1 libgcc_s.so.1; do
    cp -L "$glibc/lib/x86_64-linux-gnu/$library" "$root/root/lib/x86_64-linux-gnu/"
  done
  ln -s /lib/x86_64-linux-gnu/ld-linux-x86-64.so.2 "$root/root/lib64/"
  mkdir -p "$root/root/usr/share/doc/libc6"
  cp "$glibc/usr/share/doc/libc6/copyright" "$root/root/usr/share/doc/libc6/"
  # Certificates of services on object storage, where libraries look for them.
  mkdir -p "$root/root/etc/ssl/certs" "$root/root/usr/share/doc/ca-certificates"
  cat "$glibc"/usr/share/ca-certificates/mozilla/*.crt >"$root/root/etc/ssl/certs/ca-certificates.crt"
  cp "$glibc/usr/share/doc/ca-certificates/copyright" "$root/root/usr/share/doc/ca-certificates/"
  printf 'root:x:0:0:root:/:/bin/false\noctant:x:1000:1000:octant:/work:/bin/false\n' >"$root/root/etc/passwd"
  printf 'root:x:0:\noctant:x:1000:\n' >"$root/root/etc/group"
  # The user of the image writes there, whoever that is.
  tar -C "$root/root" --sort=name --format=gnu --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX \
    --mtime="@$SOURCE_DATE_EPOCH" --exclude=./tmp --exclude=./work -cf "$root/layer.tar" .
  tar -C "$root/root" --format=gnu --owner=1000 --group=1000 --numeric-owner --mode=a=rwxt \
    --mtime="@$SOURCE_DATE_EPOCH" -rf "$root/layer.tar" ./tmp ./work
  umoci init --layout "$layout"
  umoci new --image "$layout:$version"
  umoci raw add-layer --image "$layout:$version" --history.created "$time" --history.created_by "octant $version" "$root/layer.tar"
  umoci config --image "$layout:$version" --no-history --created "$time" --os linux --architecture amd64 \
    --author "The Octant developers" --config.entrypoint /usr/bin/octant --config.workingdir /work --config.user 1000:1000 \
    --config.env PATH=/usr/bin --config.label org.opencontainers.image.licenses="MIT OR Apache-2.0" \
    --config.label org.opencontainers.image.version="$version"
  umoci gc --layout "$layout"
  tar -C "$layout" --sort=name --format=gnu --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX \
    --mtime="@$SOURCE_DATE_EPOCH" -cf "$folder/$name.oci.tar" .
  rm -rf "$root"
}
