-- ARGV: blobs to drop.
for _, blob in ipairs(ARGV) do drop_blob(blob) end
return 1
