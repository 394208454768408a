# Completion of sphbench for bash: verbs, names and flags, as the command itself lists them.
_sphbench() {
  local word=$2 before=$3 verb=${COMP_WORDS[1]-} command=${COMP_WORDS[0]}
  local verbs='run list show sweep frames compare bless figure precision convergence profile speed report claims doctor'
  names() { "$command" list "$1" 2>/dev/null | awk '{print $1}'; }
  offer() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
  if ((COMP_CWORD == 1)); then
    offer "$verbs --help --version"
    return
  fi
  case $before in
    --solver | --solvers) offer "$(names solvers)" && return ;;
    --dim) offer '2 3' && return ;;
    --precision) offer 'float double' && return ;;
    --backend) offer 'openmp cuda' && return ;;
    --colour) offer 'speed p' && return ;;
    --over) offer 'spacing dt iterations' && return ;;
    --emit) offer 'slurm parallel' && return ;;
    -o | --manifest | --film | --json | --junit | --results | --plugin | --restart) return ;; # files
  esac
  if [[ $word == -* ]]; then
    case $verb in
      run | speed) offer "$("$command" "$verb" --help 2>/dev/null | awk '/^  -/ {print $1}')" ;;
      sweep) offer '--results --jobs --timeout --memory --fresh --dry-run --quiet --plugin --emit
        --batch --manifest --task --timed --threads' ;;
      frames) offer '-o --colour --film --quiet' ;;
      compare) offer '--all --bitwise --junit --json' ;;
      bless) offer '--reason' ;;
      figure) offer '--standard --all --results -o --jobs --quiet --plugin' ;;
      convergence) offer '--over --solvers --results --dim --precision --backend --set --error
        --spacings --spacing --iterations --dt-factors --t-end --seeds --seed --jitter --jobs
        --timeout --json --quick --quiet --plugin' ;;
      *) offer '--json --plugin --backend --dim --precision' ;;
    esac
    return
  fi
  case $verb in
    run | precision | convergence) offer "$(names scenes)" ;;
    list) offer 'solvers scenes figures metrics variants plans' ;;
    show) offer "$(names solvers) $(names scenes) $(names figures) $(names metrics)" ;;
    sweep) offer "$(names plans)" ;;
    figure) offer "$(names figures)" ;;
  esac
}
complete -o default -F _sphbench sphbench
