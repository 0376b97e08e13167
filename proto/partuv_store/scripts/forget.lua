-- ARGV: job id. A running worker finds out at its next beat.
return forget(ARGV[1]) and 1 or 0
