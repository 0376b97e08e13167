-- ARGV: owner, requests per minute, burst. Returns 0 to pass, else ms to wait. One timestamp per
-- owner (the generic cell rate algorithm): when the bucket will be empty again.
local interval = 60000 / tonumber(ARGV[2])
local name = key('rate', ARGV[1])
local time = now()
local empty_at = math.max(tonumber(redis.call('GET', name) or '0'), time)
local wait = empty_at - time - interval * (tonumber(ARGV[3]) - 1)
if wait > 0 then return math.ceil(wait) end
redis.call('SET', name, text(empty_at + interval), 'PX', text(math.ceil(empty_at + interval - time)))
return 0
