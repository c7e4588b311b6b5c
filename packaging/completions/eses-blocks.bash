# bash completion for eses-blocks and its tools: reads the options from --help-all.
# shellcheck shell=bash disable=SC2016,SC2034,SC2154,SC2207

# Options of MSMS have a single dash.
_eses_msms() {
  case $prev in
    -surface) COMPREPLY=($(compgen -W 'tses ases' -- "$cur")) ;;
    -density | -hdensity | -probe_radius | -one_cavity) ;;
    *)
      if [[ $cur == -* ]]; then
        COMPREPLY=($(compgen -W '-probe_radius -density -hdensity -surface -no_area -noh -if -of -af
          -no_header -all_components -one_cavity --allow-far-atoms --help --version' -- "$cur"))
      else
        _filedir
      fi
      ;;
  esac
}

# Completes the last name of a list with commas. The names before it are not offered again.
_eses_list() {
  local before= left= name
  if [[ $cur == *,* ]]; then before=${cur%,*},; fi
  for name in $1; do
    if [[ ,$before != *",$name,"* ]]; then left+=" $name"; fi
  done
  COMPREPLY=($(compgen -P "$before" -W "$left" -- "${cur##*,}"))
  compopt -o nospace
}

_eses_blocks() {
  local cur prev words cword split
  _init_completion -s || return
  local command=
  if ((cword > 1)) && [[ ${words[1]} == @(diff|interface|measure|msms|pdb_to_xyzr|pdb_to_xyzrn) ]]; then
    command=${words[1]}
  fi
  if [[ $command == msms ]]; then
    _eses_msms
    return
  fi

  local tables='atoms residues chains derivatives cavities pieces pockets rsa seq res pdb cif'
  case $prev in
    --format) COMPREPLY=($(compgen -W 'auto xyzr pqr pdb mmcif' -- "$cur")) && return ;;
    --write)
      case $command in
        measure) _eses_list "$tables" ;;
        interface) _eses_list 'interfaces residues atoms pdb cif' ;;
        *) _eses_list 'all none grid edges areas residues atoms' ;;
      esac
      return
      ;;
    --table)
      if [[ $command == interface ]]; then tables='interfaces residues atoms pdb cif'; fi
      COMPREPLY=($(compgen -W "$tables" -- "$cur")) && return
      ;;
    --like) COMPREPLY=($(compgen -W 'freesasa biopython mdtraj zsasa pymol' -- "$cur")) && return ;;
    --radii) _filedir && COMPREPLY+=($(compgen -W 'protor bondi msms naccess oons protor+shannon bondi+shannon occupancy' -- "$cur")) && return ;;
    --hydrogens) COMPREPLY=($(compgen -W 'keep drop' -- "$cur")) && return ;;
    --chain-names) COMPREPLY=($(compgen -W 'auth label' -- "$cur")) && return ;;
    --surface)
      if [[ $command == measure ]]; then
        _eses_list 'ses sas vdw all'
      else
        COMPREPLY=($(compgen -W 'ses sas vdw' -- "$cur"))
      fi
      return
      ;;
    --reference) COMPREPLY=($(compgen -W 'tien miller sander' -- "$cur")) && return ;;
    --parts) COMPREPLY=($(compgen -W chains -- "$cur")) && return ;;
    --model) if [[ $command == @(measure|interface) ]]; then COMPREPLY=($(compgen -W all -- "$cur")); fi; return ;;
    --csv) _filedir csv && return ;;
    --color) COMPREPLY=($(compgen -W 'patch atom chain potential component' -- "$cur")) && return ;;
    --component) COMPREPLY=($(compgen -W outside -- "$cur")) && return ;;
    --mesh) _filedir '@(ply|obj|off|vtp|stl|glb|vert|face)' && return ;;
    --inside) _filedir '@(dx|dx.gz|vti)' && return ;;
    --kappa | --potential) _filedir 'dx?(.gz)' && return ;;
    --grid-like) _filedir '@(dx|vti|txt)?(.gz)' && return ;;
    --dielectric) _filedir && return ;;
    --output-dir | -o) _filedir -d && return ;;
    # These options take numbers, which cannot be completed.
    --probe-radius | --probe-in | --probe-out | --at | --report | --spacing | --margin | \
      --threads | -t | --block-size | -b | --max-memory | \
      --region | --blocks | --tolerance | --grid-origin | --grid-center | --grid-points | \
      --solute-dielectric | --solvent-dielectric | --ion-radius | --potential-offset | \
      --potential-limit | --ligand | --groups | --area-cutoff | --residue-cutoff) return ;;
  esac
  if $split; then return; fi

  if [[ $cur == -* ]]; then
    if [[ -n $command ]]; then
      COMPREPLY=($(compgen -W '$(_parse_help "$1" "$command --help-all")' -- "$cur"))
    else
      COMPREPLY=($(compgen -W '$(_parse_help "$1" --help-all)' -- "$cur"))
    fi
    if [[ ${COMPREPLY-} == *= ]]; then compopt -o nospace; fi
  elif [[ $command == diff ]]; then
    _filedir -d
  else
    _filedir '@(xyzr|pqr|pdb|pdb+([0-9])|pdbx|ent|cif|mmcif|mcif)?(.gz)'
    if ((cword == 1)); then COMPREPLY+=($(compgen -W 'diff interface measure msms pdb_to_xyzr pdb_to_xyzrn' -- "$cur")); fi
  fi
}
complete -F _eses_blocks eses-blocks

_eses_tool() {
  local cur prev words cword split
  _init_completion -s || return
  # COLUMNS keeps the names of options and their descriptions, which begin after two blanks, in a line.
  local names
  names=$(COLUMNS=1000 "$1" --help-all 2>/dev/null | sed -n -e '/^  -/{s/^  //;s/   *.*//;p;}')
  local chosen="(^|[[:space:]])$prev \{([^}]*)\}"  # the names that are values of the option
  if [[ $prev == -* && $names =~ $chosen ]]; then
    COMPREPLY=($(compgen -W "${BASH_REMATCH[2]//,/ }" -- "$cur"))
  elif [[ $cur == -* ]]; then
    COMPREPLY=($(compgen -W "$(grep -oE -e '--[a-z-]+' <<<"$names")" -- "$cur"))
  else
    _filedir
  fi
}
complete -F _eses_tool eses-apbs eses-assemble eses-pdbbind eses-render eses-report eses-traj eses-view \
  eses-pdb_to_xyzr eses-pdb_to_xyzrn

_eses_msms_program() {
  local cur prev words cword
  _init_completion || return
  _eses_msms
}
complete -F _eses_msms_program eses-msms
