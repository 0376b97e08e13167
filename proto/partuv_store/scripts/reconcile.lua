-- Blobs that expired by themselves (abandoned uploads) leave the ledger. Returns how many.
local gone = 0
for _, blob in ipairs(redis.call('HKEYS', key('ledger'))) do
  if redis.call('EXISTS', key('blob', blob)) == 0 then
    drop_blob(blob)
    gone = gone + 1
  end
end
return gone
