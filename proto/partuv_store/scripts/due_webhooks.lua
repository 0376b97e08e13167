-- ARGV: lease in ms, at most. Takes webhooks that are due; another sender sees them after the lease.
local time = now()
local due = redis.call('ZRANGEBYSCORE', key('webhooks'), '-inf', text(time), 'LIMIT', 0, ARGV[2])
for _, id in ipairs(due) do
  redis.call('ZADD', key('webhooks'), text(time + tonumber(ARGV[1])), id)
end
return due
