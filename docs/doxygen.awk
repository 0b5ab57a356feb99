# Sources and pages as Doxygen reads them. In a source, the comment at the top becomes the page of the file or of the example, what
# is no name of the library's is left out, and what is text stays text; lines keep their order and nearly their numbers. In a
# page, links to examples lead to their pages.
#
#     awk -f docs/doxygen.awk include/mica/law/exact.hpp
FILENAME ~ /\.md$/ {
    while (match($0, /\]\([.\/]*examples\/[a-z_]*\.cpp\)/)) {
        link = substr($0, RSTART, RLENGTH - 5)
        $0 = substr($0, 1, RSTART - 1) "](" name(link) "_8cpp-example.html)" substr($0, RSTART + RLENGTH)
    }
    print
    next
}

FNR == 1 { at_top = sub(/^\/\/ mica\/[^ :]*: /, "/// @file\n///\n/// ") || sub(/^\/\/ /, "/// @example " name(FILENAME) "\n/// ") }
at_top && /^\/\/($|[^\/])/ { sub(/^\/\//, "///") }
!/^\/\// { at_top = 0 }
FILENAME ~ /\.cpp$/ && !at_top { exit } # the page has the whole file

# Macros that a header undefines again, and words in front of a function that are not for its callers.
/^#(define|undef) MICA_(PACK|PAIR|SMALLER|LARGER)_/ { in_macro = 1 }
in_macro { in_macro = /\\$/; print ""; next }
/^ *MICA_(PACK|PAIR)_[A-Z]*\(/ { print ""; next }
FILENAME !~ /config\.hpp$/ && !/^ *\/\// { gsub(/MICA_(HOST_DEVICE|FLATTEN|WIDE|UNROLL|CONTRACT) ?/, "") }

# A law says of itself what its header says.
FILENAME ~ /\/law\// && /^(struct|class) [a-z_]*(binomial|_distribution) {$/ { $0 = "/** @copydetails " name(FILENAME) " */ " $0 }

# The comment behind several names is that of each.
/^ *[A-Za-z][A-Za-z_0-9:<>]* [a-z_0-9]+( = [0-9.]+)?(, [a-z_0-9]+( = [0-9.]+)?)+; *\/\/\/< / { $0 = one_by_one($0) }

/^ *\/\/\/|\/\/\/</ { $0 = escaped($0) }

# At the top "Error: ..." begins a line; that it goes on indented makes it neither a list nor code.
at_top && /^\/\/\/   ?[^ ]/ { sub(/^\/\/\/   ?/, "/// ") }
at_top && match($0, /^\/\/\/ (Sources?|Draws|Output|Errors?|Departures|Numerics|Method|Domain)(, [^:]*)?:/) {
    $0 = "/// <br>**" substr($0, 5, RLENGTH - 4) "**" substr($0, RLENGTH + 1)
}

{ print }

function name(path) { sub(/.*\//, "", path); return path }

# "Real x; /**< the components */ Real y; /**< the components */" for "Real x, y; ///< the components"
function one_by_one(line, comment, names, count, i, type, result) {
    comment = line
    sub(/.*\/\/\/< /, "", comment)
    sub(/; *\/\/\/<.*/, "", line)
    count = split(line, names, ", ")
    type = names[1]
    sub(/ [a-z_0-9]+( = [0-9.]+)?$/, "", type)
    result = names[1] "; /**< " comment " */"
    for (i = 2; i <= count; ++i) result = result type " " names[i] "; /**< " comment " */"
    return result
}

# \< for <, but for what stands in `` or is indented as a block of code.
function escaped(line, parts, count, i, result) {
    if (line ~ /^ *\/\/\/     /) return line
    match(line, /\/\/\/<?/)
    result = substr(line, 1, RSTART + RLENGTH - 1)
    count = split(substr(line, RSTART + RLENGTH), parts, "`")
    for (i = 1; i <= count; ++i) result = result (i > 1 ? "`" : "") (i % 2 ? without_tags(parts[i]) : parts[i])
    return result
}

function without_tags(text, parts, count, i, result) { # not by gsub: awks differ in what a \ in its replacement means
    count = split(text, parts, "<")
    result = parts[1]
    for (i = 2; i <= count; ++i) result = result "\\<" parts[i]
    return result
}
