# Completion of the refract_* tools for bash: their options, and the values of those that list them, as --help says; else files.
_refract()
{
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} option=""
    # Bash takes --option=value for three words.
    if [[ $word == "=" ]]; then
        option=$before word=""
    elif [[ $before == "=" ]]; then
        option=${COMP_WORDS[COMP_CWORD-2]}
    fi
    COMPREPLY=()
    if [[ $word == -* && -z $option ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$("$1" --help 2>/dev/null | sed -n 's/^  \(-[a-z],\)\{0,1\}\(--[a-z0-9-]*\).*/\2/p')" -- "$word")
        return
    fi
    local values=""
    if [[ -n $option ]]; then
        values=$("$1" --help 2>/dev/null | sed -n "s/^  $option [A-Z]*:{\([^}]*\)}.*/\1/p" | tr ',' ' ')
    fi
    if [[ -n $values ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$values" -- "$word")
    else
        compopt -o filenames 2>/dev/null || :         # no completion is under way in a test
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
    fi
}
complete -F _refract refract_accept refract_board refract_bundle refract_calib refract_check refract_epilines refract_export refract_laser \
    refract_match refract_measure refract_simulate refract_stereo refract_undistort
