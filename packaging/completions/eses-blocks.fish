# fish completion for eses-blocks and its tools: reads the options and their descriptions from --help-all.

set -l tools apbs assemble pdbbind render report traj view
set -l commands diff interface measure msms pdb_to_xyzr pdb_to_xyzrn

# Prints the command of the line: a command of eses-blocks, or nothing.
function __eses_blocks_command
    set -l words (commandline -opc)
    if set -q words[2]; and contains -- $words[2] diff interface measure msms pdb_to_xyzr pdb_to_xyzrn
        echo $words[2]
    end
end

# Prints the options of a program and their descriptions, which tabs separate. Lines that are indented
# far to the right continue a description.
function __eses_blocks_options
    set -l words (commandline -opc)
    COLUMNS=1000 $words[1] $argv --help-all 2>/dev/null | awk '
        function show() { for (i = 1; i <= count; i++) print names[i] "\t" meaning; count = 0 }
        /^  -/ {
            show()
            head = line = substr($0, 3); meaning = ""
            if (match(line, /   */)) { head = substr(line, 1, RSTART - 1); meaning = substr(line, RSTART + RLENGTH) }
            count = split(head, names, ", ")
            for (i = 1; i <= count; i++) sub(/[ =\[].*/, "", names[i])
            next
        }
        /^                    / { sub(/^ +/, ""); meaning = meaning (meaning == "" ? "" : " ") $0; next }
        { show() }
        END { show() }'
end

# Prints the option whose value is completed, and the text before the value: for --write=a they are --write
# and --write=, otherwise the last word before the cursor and nothing.
function __eses_blocks_option
    set -l joined (string match -r -- '^(--[\w-]+)=' (commandline -ct))
    if set -q joined[2]
        printf '%s\n' $joined[2] $joined[1]
    else
        set -l words (commandline -opc)
        printf '%s\n' $words[-1] ''
    end
end

# Prints a list with commas, whose last name is one of the arguments. The names before it are not offered again.
function __eses_blocks_list
    set -l before (commandline -ct | string replace -r -- '^--[\w-]+=' '' | string match -r '.*,')
    for name in $argv
        string match -q -- "*,$name,*" ",$before"; or echo "$before$name"
    end
end

# Prints the values of the option before the cursor.
function __eses_blocks_values
    set -l option (__eses_blocks_option)
    set -l names (__eses_blocks_names $option[1])
    or return 1
    printf '%s\n' $option[2]$names
end

# Prints the names that an option takes. Returns 1 if there are none.
function __eses_blocks_names
    set -l words (commandline -opc)
    set -l tables atoms residues chains derivatives cavities pieces pockets rsa seq res pdb cif
    switch "$argv[1]"
        case --format
            printf '%s\n' auto xyzr pqr pdb mmcif
        case --color
            printf '%s\n' patch atom chain potential component
        case --component
            echo outside
        case --radii
            printf '%s\n' protor bondi msms naccess oons protor+shannon bondi+shannon occupancy
        case --chain-names
            printf '%s\n' auth label
        case --like
            printf '%s\n' freesasa biopython mdtraj zsasa pymol
        case --hydrogens
            printf '%s\n' keep drop
        case --reference
            printf '%s\n' tien miller sander
        case --parts
            echo chains
        case --model
            echo all
        case --surface
            if contains measure $words[2]
                __eses_blocks_list ses sas vdw all
            else
                printf '%s\n' ses sas vdw
            end
        case -surface
            printf '%s\n' tses ases
        case --table
            if contains interface $words[2]
                printf '%s\n' interfaces residues atoms pdb cif
            else
                printf '%s\n' $tables
            end
        case --write
            if contains measure $words[2]
                __eses_blocks_list $tables
            else if contains interface $words[2]
                __eses_blocks_list interfaces residues atoms pdb cif
            else
                __eses_blocks_list all none grid edges areas residues atoms
            end
        case '*'
            return 1
    end
end

# Prints the names that are values of the option of a tool before the cursor, such as {sticks,surface}.
function __eses_tool_values
    set -l words (commandline -opc)
    set -l option (__eses_blocks_option)
    string match -q -- '-*' $option[1]; or return 1
    set -l found (COLUMNS=1000 $words[1] --help-all 2>/dev/null | string match -r -- "^  (?:-\w \S+, )?$option[1] \{([^}]*)\}")
    set -q found[2]; and printf '%s\n' $option[2](string split , $found[2])
end

complete -c eses-blocks -n 'test -z "$(__eses_blocks_command)"; and test (count (commandline -opc)) = 1' -a "$commands"
complete -c eses-blocks -n 'string match -q -- "-*" (commandline -ct)' -a '(__eses_blocks_options (__eses_blocks_command))'
complete -c eses-blocks -n __eses_blocks_values -f -a '(__eses_blocks_values)'
for name in msms pdb_to_xyzr pdb_to_xyzrn
    complete -c eses-$name -n 'string match -q -- "-*" (commandline -ct)' -a '(__eses_blocks_options)'
    complete -c eses-$name -n __eses_blocks_values -f -a '(__eses_blocks_values)'
end
for name in $tools
    complete -c eses-$name -n __eses_tool_values -f -a '(__eses_tool_values)'
    complete -c eses-$name -n 'string match -q -- "-*" (commandline -ct)' -a '(__eses_blocks_options)'
end
