#!/usr/bin/env bash
# The checks of the sources that need no tests: ./.ci/checks.sh [format|format --fix|locks|tidy]..., all of them without
# arguments. Each prints one line about what it has checked, and the script ends with 1 where one has found something.
set -euo pipefail
# shellcheck source=.ci/packages.sh
. "$(dirname "${BASH_SOURCE[0]}")/packages.sh"
cd "$strata_root"

folders=(core io lod render converter viewer tests)
checks_build=build/checks       # configured for its compile commands alone, without precompiled headers
tidy_seconds=${STRATA_TIDY_SECONDS:-300}

# clang-format lays out code differently from release to release: only this one decides.
format_version=14
find_format() {
  command -v "clang-format-$format_version" || command -v clang-format || die "clang-format is not installed"
}

sources() { git ls-files -- "${folders[@]/%//*.h}" "${folders[@]/%//*.cpp}"; }

check_format() {
  local format bad
  format=$(find_format)
  if ! "$format" --version | grep -q "version $format_version\."; then
    say "format: skipped, $("$format" --version | grep -o 'version [0-9]*') is not version $format_version"
    return
  fi
  if [ "${1:-}" = --fix ]; then
    sources | xargs "$format" -i
    say "format: all sources are formatted now"
    return
  fi
  bad=$({ sources | xargs "$format" --dry-run -Werror 2>&1 || true; } |
    sed -n 's/^\([^:]*\):.*-Wclang-format-violations.*/\1/p' | sort -u)
  [ -z "$bad" ] || die "format: not formatted (./.ci/checks.sh format --fix mends it): $(tr '\n' ' ' <<<"$bad")"
  say "format: $(sources | wc -l) sources are formatted"
}

# The sources that see core/mutex.h, directly or through other headers of ours.
sources_with_locks() {
  local found=core/mutex.h before=
  while [ "$found" != "$before" ]; do
    before=$found
    found=$({
      printf '%s\n' "$before"
      git grep -lFf <(grep '\.h$' <<<"$before" | xargs printf '#include "%s"\n') -- "${folders[@]:0:6}"
    } | sort -u)
  done
  grep '\.cpp$' <<<"$found"
}

configure_checks() {
  [ -f "$checks_build/compile_commands.json" ] ||
    cmake --preset release -B "$checks_build" -DSTRATA_PRECOMPILE=OFF --log-level=WARNING >/dev/null ||
    die "configuring failed"
}

check_locks() {
  local files includes log
  command -v clang++ >/dev/null || die "clang++ is not installed"
  mapfile -t files < <(sources_with_locks)
  [ ${#files[@]} -gt 0 ] || die "locks: no source includes core/mutex.h"
  mapfile -t includes < <(pkg-config --cflags-only-I imgui pcl_io | tr ' ' '\n' | sed -n 's/^-I/-isystem/p')
  log=$(mktemp)
  printf '%s\0' "${files[@]}" | xargs -0 -P "$(nproc)" -n 1 clang++ -std=c++20 -I. "${includes[@]}" \
    -DGLM_FORCE_XYZW_ONLY -DGLM_ENABLE_EXPERIMENTAL -w -Wthread-safety -Werror=thread-safety -fsyntax-only >"$log" 2>&1 || {
    cat "$log" >&2
    rm -f "$log"
    die "locks: clang++ -Wthread-safety found a member that is used without its lock"
  }
  rm -f "$log"
  say "locks: ${#files[@]} sources keep the discipline that their annotations state"
}

# What the changes are counted from: STRATA_BASE, the branch's parting from origin/main, or the commit before.
tidy_base() {
  local base=${STRATA_BASE:-}
  [ -n "$base" ] || base=$(git merge-base HEAD origin/main 2>/dev/null || true)
  if [ -z "$base" ] || [ "$(git rev-parse "$base" 2>/dev/null)" = "$(git rev-parse HEAD)" ]; then base=HEAD~1; fi
  git rev-parse --verify -q "$base^{commit}" || true
}

check_tidy() {
  local base files began file findings checked=0
  command -v clang-tidy >/dev/null || die "clang-tidy is not installed"
  base=$(tidy_base)
  if [ -z "$base" ]; then
    say "tidy: skipped, there is no earlier commit to compare with"
    return
  fi
  mapfile -t files < <(git diff --name-only --diff-filter=d "$base" -- "${folders[@]:0:6}" | grep '\.cpp$' || true)
  if [ ${#files[@]} -eq 0 ]; then
    say "tidy: no source has changed since $(git rev-parse --short "$base")"
    return
  fi
  configure_checks
  began=$SECONDS
  findings=$(mktemp)
  for file in "${files[@]}"; do
    ((SECONDS - began < tidy_seconds)) || break
    clang-tidy -p "$checks_build" --quiet --warnings-as-errors='*' "$file" >>"$findings" 2>/dev/null || {
      cat "$findings" >&2
      rm -f "$findings"
      die "tidy: findings in $file"
    }
    checked=$((checked + 1))
  done
  rm -f "$findings"
  say "tidy: $checked of ${#files[@]} sources changed since $(git rev-parse --short "$base") are clean" \
    "(STRATA_TIDY_SECONDS=$tidy_seconds)"
}

if [ $# -eq 0 ]; then set -- format locks tidy; fi
while [ $# -gt 0 ]; do
  case $1 in
    format) if [ "${2:-}" = --fix ]; then check_format --fix && shift; else check_format; fi ;;
    locks) check_locks ;;
    tidy) check_tidy ;;
    *) printf 'error: unknown check %s (expected format, locks or tidy)\n' "$1" >&2 && exit 2 ;;
  esac
  shift
done
