# Shared by scripts/bundle and scripts/wheel through pack.sh: licence texts of everything that is packed below $root.
#
# $root/.packed has a row for each file from elsewhere: its place below $root, a tab, and where it came from. A program has a row for
# each static library within it.

# packed PLACE SOURCE: notes where a file of the package came from
packed() { printf '%s\t%s\n' "$1" "$2" >>"$root/.packed"; }

# Static libraries of a program of a build, without those of this project: static_libraries BUILD PROGRAM
static_libraries() {
  local build=$1 program=$2 word folder folders=() words
  [ -f "$build/build.ninja" ] || die "$build has no build.ninja, which says what its programs hold; takes a build with Ninja"
  words=$(awk -v program="build $program:" 'index($0, program) == 1 { on = 1 } on && /^$/ { exit }
    on && /^ +LINK_(LIBRARIES|PATH) =/ { sub(/^[^=]*=/, ""); print }' "$build/build.ninja")
  for word in $words; do
    case $word in -L*) folders+=("${word#-L}") ;; esac
  done
  for word in $words; do
    case $word in
      -l:*.a) "${CXX:-g++}" -print-file-name="${word#-l:}" ;;
      -l*)
        for folder in "${folders[@]}"; do
          if [ ! -e "$folder/lib${word#-l}.so" ] && [ -e "$folder/lib${word#-l}.a" ]; then echo "$folder/lib${word#-l}.a"; fi
        done ;;
      /*.a) echo "$word" ;;
    esac
  done | xargs -r realpath | grep -vE '/lib(c|m|dl|pthread|rt)\.a$' | sort -u
}

# Texts of a library that no package manager installed, one a line: those that scripts/setup keeps, and those of a CUDA toolkit.
# Below MPM_LICENCES a user names others, by the library: petsc for libpetsc.a.
own_licences() {  # FILE
  local name folder=$1 text
  name=$(basename "$1"); name=${name#lib}; name=${name%%.*}
  if [ -n "${MPM_LICENCES:-}" ] && [ -e "$MPM_LICENCES/$name" ]; then find -L "$MPM_LICENCES/$name" -type f; return; fi
  while folder=$(dirname "$folder"); [ "$folder" != / ] && [ "$folder" != /usr ]; do
    if [ -d "$folder/share/licences" ]; then find "$folder/share/licences" -type f; return; fi
    case $name in
      cudart* | cudadevrt* | culibos*)
        for text in "$folder"/EULA.txt "$folder"/dist-info/nvidia_cuda_runtime-*/licenses/*; do
          if [ -f "$text" ]; then echo "$text"; return; fi
        done ;;
    esac
  done
}

# Rows of Debian's packages that have the files on stdin: package, a tab, file. Files below /lib may be listed without /usr, and the other
# way round.
debian_packages() {
  command -v dpkg-query >/dev/null || return 0
  sed 'p; s,^/usr/,/,; t; s,^,/usr,' | xargs -rd '\n' dpkg-query -S 2>/dev/null | sed -n 's/^\([^:, ]*\)[^ ]*: /\1\t/p' || true
}

# Copies the licence of one file from elsewhere, and prints the row of INDEX.tsv: place, origin, folder of the texts.
pack_licence() {  # PLACE SOURCE PACKAGE
  local to=$root/share/licences package=$3 texts name
  if [ -n "$package" ] && [ -f "/usr/share/doc/$package/copyright" ]; then
    if [ ! -d "$to/$package" ]; then mkdir "$to/$package" && cp -L "/usr/share/doc/$package/copyright" "$to/$package"; fi
    printf '%s\tDebian %s\t%s\n' "$1" "${versions[$package]:-}" "$package"
    return
  fi
  name=$(basename "$2" | sed 's/^lib//; s/[.].*//')
  texts=$(own_licences "$2")
  [ -n "$texts" ] || die "no licence text of $2; put it into a folder and name that in MPM_LICENCES: $name/LICENSE"
  case $texts in */share/licences/*) name=$(echo "$texts" | sed -n '1s,.*/share/licences/\([^/]*\)/.*,\1,p') ;; esac
  mkdir -p "$to/$name"
  echo "$texts" | xargs -d '\n' cp -Lt "$to/$name"
  printf '%s\t%s\t%s\n' "$1" "$(basename "$2")" "$name"
}

# Writes share/licences: INDEX.tsv, a folder of texts for each origin, and the common texts that Debian's copyright files refer to.
pack_licences() {
  local place source package text to=$root/share/licences
  local -A package_of=() versions=()
  mkdir -p "$to/common"
  sort -u "$root/.packed" >"$root/.rows"
  while IFS=$'\t' read -r package source; do package_of[${source#/usr}]=$package; done < <(cut -f2 "$root/.rows" | debian_packages)
  while IFS=$'\t' read -r package text; do versions[$package]=$text; done < <(printf '%s\n' "${package_of[@]}" | sort -u |
    xargs -r dpkg-query -W -f '${Package}\t${source:Package} ${source:Version}\n')
  while IFS=$'\t' read -r place source; do pack_licence "$place" "$source" "${package_of[${source#/usr}]:-}"; done <"$root/.rows" >"$to/INDEX.tsv"
  rm "$root/.packed" "$root/.rows"
  for text in $(grep -rhoE '/usr/share/common-licenses/[A-Za-z0-9.+-]*[A-Za-z0-9+]' "$to" | sort -u); do
    if [ -f "$text" ]; then cp -L "$text" "$to/common"; fi
  done
}
