# zig (package ziglang) as compiler and linker for Linux with glibc 2.17 or later, on any machine.

# zig_linker TRIPLE FOLDER PYTHON: writes the tools into the folder, and tells cargo, and the build scripts that compile C,
# to use them for the target; $zig_cc is the compiler.
zig_linker() {
  local triple=$1 folder=$2 zig name
  zig="$(realpath -s "$(command -v "$3")") -m ziglang"
  mkdir -p "$folder"
  folder=$(realpath "$folder")
  zig_cc=$folder/cc
  # Rust names the target in its own way, and zig takes none beside its own. Checks of undefined behaviour, which zig adds
  # to C that isn't optimized, would need a library of it.
  cat >"$folder/cc" <<END
#!/bin/bash
args=()
for a in "\$@"; do case \$a in --target=*) ;; *) args+=("\$a") ;; esac; done
exec $zig cc -target ${triple/unknown-/}.2.17 -fno-sanitize=undefined "\${args[@]}"
END
  printf '#!/bin/sh\nexec %s ar "$@"\n' "$zig" >"$folder/ar"
  chmod +x "$folder/cc" "$folder/ar"
  name=$(tr a-z- A-Z_ <<<"$triple")
  export "CARGO_TARGET_${name}_LINKER=$folder/cc" "CC_${triple//-/_}=$folder/cc" "AR_${triple//-/_}=$folder/ar"
}
