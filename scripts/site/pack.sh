# Shared by scripts/bundle and scripts/wheel: puts programs, Open MPI and every library that they need below $root, where
# bundle_launch (root/bin/launch) starts them. The caller sets source_dir, root, and builds, an array of build folders.
. "$source_dir/scripts/site/licences.sh"

# Builds the presets that are named, or the default one, and adds their folders to builds: build_presets DEFAULT PRESET...
build_presets() {
  local default=$1 preset
  shift
  [ $# -gt 0 ] || set -- "$default"
  for preset in "$@"; do
    build "$preset"
    builds+=("$source_dir/build/$preset")
  done
}

version_of_source() { sed -n 's/^project(mpm VERSION \([0-9.]*\).*/\1/p' "$source_dir/CMakeLists.txt"; }

# A command of the package: `link` in archives, `copy` in wheels, which hold no links.
starts() {
  case ${pack_links:-link} in
    link) ln -sf launch "$root/bin/$1" ;;
    copy) cp "$root/bin/launch" "$root/bin/$1" ;;
  esac
}

# Programs of the builds, and the processor for which each was compiled (MPM_ARCH): pack_programs PROGRAM..., below a build folder
pack_programs() {
  local build program library place
  mkdir -p "$root"/{bin,lib/openmpi,libexec,share}
  install -m 755 "$source_dir/scripts/site/bundle_launch" "$root/bin/launch"
  for build in "${builds[@]}"; do
    [ -x "$build/app/mpm" ] || die "there is no program $build/app/mpm"
    place=$root/libexec/${build##*/}
    for program in "$@"; do
      if [ -x "$build/$program" ]; then
        install -Dm 755 -s "$build/$program" "$place/${program##*/}"
        starts "${program##*/}"
        for library in $(static_libraries "$build" "$program"); do packed "libexec/${build##*/}/${program##*/}" "$library"; done
      fi
    done
    sed -n 's/^MPM_ARCH:[A-Z]*=//p' "$build/CMakeCache.txt" >"$place/processor"
  done
}

# mpirun with its daemon, plugins and messages. Left out: plugins of networks between nodes, whose libraries belong to the
# machine, and of OpenSHMEM.
pack_mpi() {
  local program plugin
  place_of() { ompi_info --parsable --path "$1" | cut -d: -f3; }
  if ! command -v ompi_info >/dev/null; then
    echo "${0##*/}: this MPI is not Open MPI; there will be no mpirun" >&2
    return
  fi
  for program in mpirun orted; do
    install -m 755 "$(readlink -f "$(place_of bindir)/$program")" "$root/libexec/$program"
    packed "libexec/$program" "$(readlink -f "$(place_of bindir)/$program")"
  done
  starts mpirun
  cp "$(place_of pkglibdir)"/*.so "$root/lib/openmpi"
  rm -f "$root"/lib/openmpi/*{ucx,ofi,psm,openib,usnic,_uct,spml,scoll,sshmem,memheap,dbg_msgq}*
  for plugin in "$root"/lib/openmpi/*.so; do packed "lib/openmpi/${plugin##*/}" "$(readlink -f "$(place_of pkglibdir)/${plugin##*/}")"; done
  cp -r "$(place_of pkgdatadir)" "$root/share/openmpi"
  packed share/openmpi "$(readlink -f "$(find "$(place_of pkgdatadir)/" -type f | sort | head -n 1)")"
}

# Left out: libraries of glibc, which belong to the machine's kernel, and libcuda, which belongs to its driver.
left_out='/(lib(c|m|mvec|dl|pthread|rt|resolv|util|nsl|anl|thread_db)|ld-linux[^/]*)\.so|^lib(cuda|nvidia)'
copy_libraries() {  # FILE...
  local needed missing library
  needed=$(ldd "$@" 2>/dev/null)
  missing=$(echo "$needed" | awk '$3 == "not" { print $1 }' | sort -u | grep -vE "$left_out" || true)
  [ -z "$missing" ] || die "not found: $missing"
  for library in $(echo "$needed" | awk '$3 ~ /^\// { print $3 }' | grep -vE "$left_out|/lib(cuda|nvidia)" | sort -u); do
    cp -Lt "$root/lib" "$library"
    packed "lib/${library##*/}" "$(readlink -f "$library")"
  done
}
pack_libraries() {
  local pmix programs file
  programs=$(find "$root/libexec" -type f -perm /111 -o -name '*.so')
  # shellcheck disable=SC2086
  copy_libraries $programs "$root"/lib/openmpi/*.so
  pmix=$(ldd "$root"/lib/openmpi/*.so | awk '/libpmix\.so/ { path = $3 } END { print path }')
  if [ -n "$pmix" ]; then  # a library of its own, with plugins of its own
    pmix=$(dirname "$(dirname "$(readlink -f "$pmix")")")
    cp -rL "$pmix/lib/pmix" "$root/lib/pmix"
    cp -rL "$pmix/share/pmix" "$root/share/pmix"
    for file in "$pmix"/lib/pmix/*.so "$pmix"/share/pmix/*; do packed "${file#"$pmix"/}" "$(readlink -f "$file")"; done
  fi
  pack_licences
}

# Version of glibc that the packed files need, as 2.36
glibc_of_package() {
  find "$root/libexec" "$root/lib" -type f \( -perm /111 -o -name '*.so*' \) -exec objdump -T {} + 2>/dev/null |
    grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1 | cut -d_ -f2
}
