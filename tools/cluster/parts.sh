# shellcheck shell=bash
# GPL-2.0-or-later. What the scripts of this folder have in common: the command lines of parts and joins.
#
# A stage runs in rounds. In round R, every part I writes FOLDER/roundR.I; the join of all writes FOLDER/roundS, S = R + 1,
# if there is another round, else the map. Parts and joins of later rounds read the join before, FOLDER/roundR. FOLDER is maps/x.parts, which is deleted at the end. Q3MAP2 names the program.
set -eu

program=${Q3MAP2:-q3map2}
threads=() # more options of parts and joins
# shellcheck disable=SC2034 # for the scripts
here=$(CDPATH='' cd -- "$(dirname -- "${BASH_SOURCE[0]}")" && pwd)

die() {
    echo "${0##*/}: $*" >&2
    exit 1
}

# quoted WORDS: as any shell reads them.
quoted() {
    local word
    for word; do printf "'%s' " "${word//\'/\'\\\'\'}"; done
}

# read_words N -- STAGE OPTIONS maps/x.bsp: sets count, options, map and folder. `usage` comes from the script.
read_words() {
    [[ $# -ge 4 && $1 =~ ^[1-9][0-9]*$ && $2 == -- ]] || { echo "usage: ${usage-}" >&2; exit 2; }
    count=$1
    shift 2
    options=("${@:1:$#-1}")
    map=${*: -1}
    map=${map%.map}
    map=${map%.bsp}.bsp
    folder=${map%.bsp}.parts
    [[ -f $map ]] || die "$map: no such file"
}

# start: an empty folder for parts. Other runs on the map are refused until this script ends.
start() {
    exec 9<>"$map"
    flock -n 9 || die "$map: another run is under way"
    rm -rf "$folder"
    mkdir "$folder"
}

# part_line ROUND I: sets line to the words that compute a part. The file of the round before is in `from`, or folder.
part_line() {
    local after=()
    [[ $1 == 1 ]] || after=(-join "${from-$folder}/round$1")
    # shellcheck disable=SC2034 # for the scripts
    line=("$program" "${options[@]}" "${threads[@]}" "${after[@]}" -part "$2/$count" -partfile "$folder/round$1.$2" "$map")
}

# join ROUND: joins its parts; true if there is another round. Afterwards the folder is gone, unless there is.
join() {
    local files=() next=$folder/round$(($1 + 1))
    [[ $1 == 1 ]] || files=("$folder/round$1")
    for ((i = 1; i <= count; i++)); do
        files+=("$folder/round$1.$i")
    done
    "$program" "${options[@]}" "${threads[@]}" -join "${files[@]}" -partfile "$next" "$map" || die "joining the parts of $map failed"
    rm -f "${files[@]}"
    [[ -e $next ]] || { rm -r "$folder"; return 1; }
}
