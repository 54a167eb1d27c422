# Marks the plain // comments of our headers for Doxygen:
# - /// above what they describe; they hold for all lines up to a blank one;
# - ///< beside it, where they may go on below in the same column.
# Members that explain themselves need none: destructors, constructors and
# operators that are defaulted, deleted, move or convert in one line, accessors
# `x() { return x_; }`, and fields whose names say all.
# What every factor defines is described once, in core/factors/factor.h, and what
# overrides a function of Ceres in Ceres.
function is_trivial(line) {
  return line ~ /^ *explicit [A-Z][A-Za-z0-9]*\(const [A-Z][A-Za-z0-9]*& [a-z]+\) : .*\{\}$/ ||
         line ~ /^ *(virtual )?~?[A-Z][A-Za-z0-9]*\([A-Za-z0-9&, ]*\) *(= (default|delete)|noexcept)?;$/ ||
         line ~ /^ *[A-Z][A-Za-z0-9]*& operator=\(.*\) *(= (default|delete)|noexcept);$/ ||
         line ~ /^ *[a-zA-Z:<>_&* ]+ ([a-z_]+)\(\) const \{ return [a-z_]+_(\.size\(\))?; \}$/ ||
         line ~ /^ *(int|double|size_t) (count|rmse|mean|max|min|size|width|height)( = 0(\.0)?)?;$/ ||
         line ~ /^ *[A-Za-z:<>_ ]+ (frame|camera|prev|cur);$/
}
function is_described_elsewhere(line) {
  return line ~ /^ *static constexpr (char|const char\*|int) (kName|kRows)/ ||
         line ~ /^ *using (Blocks|By[A-Za-z]+) =/ ||
         line ~ / override( \{.*|;)$/ ||
         line ~ /^ *(bool (Residual|Jacobian)|static [A-Za-z]+Factor Sample|static std::vector<std::vector<double>> Near)\(/
}
# Doxygen would take this for an address.
{ gsub(/file:line/, "file and line") }

{
  place = index($0, "//")
  before = place ? substr($0, 1, place - 1) : $0
  match($0, /^ */)
  indent = RLENGTH
}

# A comment on lines of its own.
place && before ~ /^ *$/ {
  if (place == beside) {
    print before "///<" substr($0, place + 2)
  } else {
    if (!is_above) above = ""
    above = above before "///" substr($0, place + 2) "\n"
    above_indent = indent
    is_above = 1
    is_first = 1
    beside = 0
  }
  next
}

{
  beside = 0
  is_above = 0
}

# A blank line, or the end of a class: what was said above is over.
/^ *$/ || /^ *}/ || /^ *(public|private|protected):/ {
  if (is_first) printf "%s", above
  above = ""
  is_first = 0
  print
  next
}

# Whatever begins where the comment began is described by it.
{
  is_new = is_first || (ended && indent == above_indent)
  own = place && before ~ /[;,{)] *$/ && before !~ /^ *#/
  if (above != "" && is_new && (is_first || !own)) printf "%s", above
  is_bare = above == "" || !is_new
  is_first = 0
  ended = before ~ /[;}] *$/
  if (!own && is_bare && is_trivial($0)) {
    print $0 " ///< &nbsp;"
  } else if (!own && is_bare && FILENAME ~ /(factors|calibration)\// && is_described_elsewhere($0)) {
    print "/// As every factor (core/factors/factor.h), or as Ceres has it."
    print
  } else if (own) {
    beside = place
    print before "///<" substr($0, place + 2)
  } else {
    print
  }
}
